import type { Painter } from "./painter";
import type { Rgba, Theme } from "./palette";
import { page } from "../page";
import type { Body, Other, Pose } from "../protocol";

/** Cars, obstacles and lines as they are seen from above. */

export type Point = [number, number];
const usualCar = { length: 0.58, width: 0.31, front: 0.159, rear: 0.171 };
/** The dimensions of a car, usual ones where no server has told others. */
export const carSize = () => page.hello?.car ?? { ...usualCar, ...page.hello?.problem };

export const faded = (c: Rgba, by: number): Rgba => [c[0], c[1], c[2], c[3] * by];

/** The places of points (m, forwards and to the left) that are seen from a pose. */
export function placed({ x, y, yaw }: Pose, points: Point[]): Point[] {
  const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
  return points.map(([u, v]) => [x + c * u - s * v, y + s * u + c * v]);
}

/** The points x, y, x, y ..., and their mirror images on the right in reverse order. */
function mirrored(...left: number[]): Point[] {
  const points = left.flatMap((x, i): Point[] => (i % 2 ? [] : [[x, left[i + 1]]]));
  return [...points, ...points.map(([u, v]): Point => [u, -v]).reverse()];
}

export function corners(b: Pose & { length: number; width: number }): Point[] {
  const [l, w] = [b.length / 2, b.width / 2];
  return placed(b, mirrored(l, w, -l, w));
}

export function circle(x: number, y: number, radius: number, n = 28): Point[] {
  const angles = Array.from({ length: n }, (_, i) => (2 * Math.PI * i) / n);
  return angles.map((angle) => [x + radius * Math.cos(angle), y + radius * Math.sin(angle)]);
}

export function drawObstacle(painter: Painter, theme: Theme, b: Body, isSelected: boolean) {
  const points = b.kind >= 3 ? circle(b.x, b.y, b.length / 2) : corners(b);
  const [r, g, blue] = theme.collided;
  if (b.kind === 6) {
    painter.outline(points, isSelected ? theme.selected : theme.plan, 3);
    return painter.dot(b.x, b.y, 6, theme.plan);
  }
  painter.fill(points, b.kind === 5 ? theme.opponent : b.touched ? [r, g, blue, 1] : theme.obstacle);
  painter.outline(points, isSelected ? theme.selected : theme.obstacleEdge, isSelected ? 2.5 : 1.2);
  if (b.kind === 1) {
    const [l, w] = [0.12 * b.length, 0.4 * b.width];
    painter.outline(placed(b, mirrored(2 * l, w, 0, w)), faded(theme.obstacleEdge, 0.7), 1);
  }
}

export function drawPolygon(painter: Painter, theme: Theme, xy: Float32Array) {
  const points = Array.from({ length: xy.length / 2 }, (_, i): Point => [xy[2 * i], xy[2 * i + 1]]);
  painter.fill(points, theme.obstacle);
  painter.outline(points, theme.obstacleEdge, 1.2);
}

/** The body of a problem: its lines, and a box whose front is marked, or a dot where it has no size. */
export function drawFigure(painter: Painter, theme: Theme, body: Body, lines: Float32Array[]) {
  const edge = body.touched ? theme.collided : theme.carEdge;
  for (const xy of lines) painter.polyline(xy, 0, xy.length / 2, theme.car, 4);
  if (!body.length) {
    painter.dot(body.x, body.y, 15, edge);
    return painter.dot(body.x, body.y, 12, theme.car);
  }
  const [l, w] = [body.length / 2, body.width / 2];
  painter.fill(corners(body), theme.car);
  painter.outline(corners(body), edge, body.touched ? 4 : 1.2);
  const front = placed(body, mirrored(0.8 * l, 0, 0.2 * l, 0.6 * w));
  painter.fill(front, faded(theme.carEdge, 0.85));
}

/** Cars that are tracked: outlines, and a dot for each place where they may be, as opaque as it is likely. */
export function drawTracked(painter: Painter, theme: Theme, others: Other[]) {
  for (const other of others) {
    painter.outline(corners(other), theme.opponent, 2);
    for (const [k, weight] of other.weights.entries())
      for (let i = k * other.points; i < (k + 1) * other.points; ++i)
        painter.dot(other.xy[2 * i], other.xy[2 * i + 1], 4, faded(theme.opponent, 0.15 + 0.85 * weight));
  }
}

/** A car with its front wheels turned by `steer` (rad). */
export function drawCar(painter: Painter, theme: Theme, at: Pose, steer: number, body: Rgba, edge: Rgba) {
  const size = carSize();
  const [l, w] = [size.length / 2, size.width / 2];
  const wheel = (along: number, left: number, turn: number) => {
    const [[x, y]] = placed(at, [[along, left]]);
    painter.fill(corners({ x, y, yaw: at.yaw + turn, length: 0.13, width: 0.055 }), theme.wheel);
  };
  for (const left of [-0.86 * w, 0.86 * w]) {
    wheel(size.front, left, steer);
    wheel(-size.rear, left, 0);
  }
  const half = [1, 0.38, 0.82, 0.74, -0.1, 0.74, -0.3, 0.86, -1, 0.8];
  const shape = placed(at, mirrored(...half.map((v, i) => v * (i % 2 ? w : l))));
  painter.fill(shape, body);
  painter.outline(shape, edge, 1.2);
  painter.outline(corners({ ...at, length: size.length, width: size.width }), faded(body, 0.55), 1);
  const window = mirrored(0.42 * l, 0.4 * w, 0, 0.55 * w, -0.28 * l, 0.55 * w);
  painter.fill(placed(at, window), faded(edge, 0.85));
}
