import { drivenOf, page, scalar } from "../page";
import type { Body, Frame, Other, Pose } from "../protocol";
import { theme } from "../theme";
import type { Painter } from "./painter";
import type { Rgba } from "./palette";

// Bodies and obstacles as they are seen from above.

export type Point = [number, number];
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

export function drawObstacle(painter: Painter, b: Body, isSelected: boolean) {
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

export function drawPolygon(painter: Painter, xy: Float32Array) {
  const points = Array.from({ length: xy.length / 2 }, (_, i): Point => [xy[2 * i], xy[2 * i + 1]]);
  painter.fill(points, theme.obstacle);
  painter.outline(points, theme.obstacleEdge, 1.2);
}

/** Draws the driven body of a frame: a car where it has axles, else its lines and a box with its front. */
export function drawDriven(painter: Painter, frame: Frame, colour: Rgba) {
  const body = drivenOf(frame);
  if (!body) return;
  const edge = body.touched ? theme.collided : theme.carEdge;
  if (page.hello!.body.front > 0)
    return drawCar(painter, body, scalar("steer", frame.scalars) || 0, colour, edge);
  for (const xy of frame.figure ?? []) painter.polyline(xy, 0, xy.length / 2, colour, 4);
  if (!body.length) {
    painter.dot(body.x, body.y, 15, edge);
    return painter.dot(body.x, body.y, 12, colour);
  }
  const [l, w] = [body.length / 2, body.width / 2];
  painter.fill(corners(body), colour);
  painter.outline(corners(body), edge, body.touched ? 4 : 1.2);
  const front = placed(body, mirrored(0.8 * l, 0, 0.2 * l, 0.6 * w));
  painter.fill(front, faded(theme.carEdge, 0.85));
}

/** Draws the second controller's body and plan. */
export function drawGhost(painter: Painter, frame: Frame) {
  const plan = (frame.plan ?? []).flatMap(({ x, y }) => [x, y]);
  painter.dashed(plan, plan.length / 2, faded(theme.ghost, 0.9), 2.4);
  drawDriven(painter, frame, faded(theme.ghost, 0.75));
}

export const drawOpponent = (painter: Painter, body: Body) =>
  drawCar(painter, body, 0, theme.opponent, theme.carEdge);

/** Draws the place of the body that a click adds. */
export function drawPreview(painter: Painter, { x, y, kind }: { x: number; y: number; kind: number }) {
  const size = kind === 1 ? page.hello!.body : { length: 0.4, width: 0.4 };
  const points = kind === 3 ? circle(x, y, 0.15) : corners({ ...size, x, y, yaw: 0 });
  painter.outline(points, theme.obstacle, 1.5);
}

/** Draws the outline of the driven body at a pose. */
export function drawOutline(painter: Painter, at: Pose, colour: Rgba) {
  painter.outline(corners({ ...page.hello!.body, ...at }), colour, 2);
  painter.dot(at.x, at.y, 5, colour);
}

/** Draws a cross with a rim. */
export function drawCross(painter: Painter, { x, y }: { x: number; y: number }, reach: number) {
  for (const [width, colour] of [
    [7, theme.free],
    [4, theme.mark],
  ] as const)
    for (const up of [reach, -reach]) painter.segment(x - reach, y - up, x + reach, y + up, colour, width);
}

/** Cars that are tracked: outlines, and a dot for each place where they may be, as opaque as it is likely. */
export function drawTracked(painter: Painter, others: Other[]) {
  for (const other of others) {
    painter.outline(corners(other), theme.opponent, 2);
    for (const [k, weight] of other.weights.entries())
      for (let i = k * other.points; i < (k + 1) * other.points; ++i)
        painter.dot(other.xy[2 * i], other.xy[2 * i + 1], 4, faded(theme.opponent, 0.15 + 0.85 * weight));
  }
}

/** A car with its front wheels turned by `steer` (rad). */
export function drawCar(painter: Painter, at: Pose, steer: number, body: Rgba, edge: Rgba) {
  const size = page.hello!.body;
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
