import type { Painter } from "./painter";
import type { Rgba, Theme } from "./palette";
import type { Body, Other } from "../protocol";

/** Cars, obstacles and lines as they are seen from above. */

export type Point = [number, number];
export interface Pose { x: number; y: number; yaw: number }
/** Dimensions of a car, m; `front` and `rear`: from the centre of gravity to the axles. */
export interface CarSize { length: number; width: number; front: number; rear: number }
export const usualCar: CarSize = { length: 0.58, width: 0.31, front: 0.159, rear: 0.171 };

export const faded = (c: Rgba, by: number): Rgba => [c[0], c[1], c[2], c[3] * by];

export function corners(b: Pose & { length: number; width: number }): Point[] {
  const c = Math.cos(b.yaw), s = Math.sin(b.yaw), l = b.length / 2, w = b.width / 2;
  return ([[l, w], [-l, w], [-l, -w], [l, -w]] as Point[]).map(([u, v]) => [b.x + c * u - s * v, b.y + s * u + c * v]);
}

export function circle(x: number, y: number, radius: number, n = 28): Point[] {
  return Array.from({ length: n }, (_, i) => [x + radius * Math.cos((2 * Math.PI * i) / n), y + radius * Math.sin((2 * Math.PI * i) / n)]);
}

export function dashed(painter: Painter, xy: Float32Array, count: number, colour: Rgba, width: number) {
  for (let i = 0; i < count - 1; i += 2) painter.segment(xy[2 * i], xy[2 * i + 1], xy[2 * i + 2], xy[2 * i + 3], colour, width, false);
}

export function drawObstacle(painter: Painter, theme: Theme, b: Body, isSelected: boolean) {
  const points = b.kind === 3 ? circle(b.x, b.y, b.length / 2) : corners(b);
  painter.convex(points, b.touched ? [...theme.collided.slice(0, 3), 1] as unknown as Rgba : theme.obstacle);
  painter.flush();
  painter.outline(points, isSelected ? theme.selected : theme.obstacleEdge, isSelected ? 2.5 : 1.2);
  if (b.kind === 1) {
    const front = corners({ ...b, length: b.length * 0.24, width: b.width * 0.8, x: b.x + 0.12 * b.length * Math.cos(b.yaw), y: b.y + 0.12 * b.length * Math.sin(b.yaw) });
    painter.outline(front, faded(theme.obstacleEdge, 0.7), 1);
  }
  painter.flush();
}

/** Cars that are tracked: outlines, and a dot for each place where they may be, as opaque as it is likely. */
export function drawTracked(painter: Painter, theme: Theme, others: Other[]) {
  for (const other of others) {
    painter.outline(corners(other), theme.opponent, 2);
    for (const [k, weight] of other.weights.entries())
      for (let i = k * other.points; i < (k + 1) * other.points; ++i) painter.dot(other.xy[2 * i], other.xy[2 * i + 1], 4, faded(theme.opponent, 0.15 + 0.85 * weight));
  }
}

/** A car with its front wheels turned by `steer` (rad). */
export function drawCar(painter: Painter, theme: Theme, size: CarSize, { x, y, yaw }: Pose, steer: number, body: Rgba, edge: Rgba) {
  const c = Math.cos(yaw), s = Math.sin(yaw);
  const place = (u: number, v: number): Point => [x + c * u - s * v, y + s * u + c * v];
  const l = size.length / 2, w = size.width / 2;
  for (const [along, turn] of [[size.front, steer], [-size.rear, 0]]) {
    for (const side of [-1, 1]) {
      const [wx, wy] = place(along, side * w * 0.86);
      painter.convex(corners({ x: wx, y: wy, yaw: yaw + turn, length: 0.13, width: 0.055 }), theme.wheel);
    }
  }
  painter.flush();
  const shape = ([[l, 0.38 * w], [0.82 * l, 0.74 * w], [-0.1 * l, 0.74 * w], [-0.3 * l, 0.86 * w], [-l, 0.8 * w], [-l, -0.8 * w], [-0.3 * l, -0.86 * w], [-0.1 * l, -0.74 * w], [0.82 * l, -0.74 * w], [l, -0.38 * w]] as Point[]).map(([u, v]) => place(u, v));
  painter.convex([...shape], body);
  painter.flush();
  painter.outline(shape, edge, 1.2);
  painter.outline(corners({ x, y, yaw, length: size.length, width: size.width }), faded(body, 0.55), 1);
  painter.convex(([[0.42 * l, 0.4 * w], [0.0, 0.55 * w], [-0.28 * l, 0.55 * w], [-0.28 * l, -0.55 * w], [0, -0.55 * w], [0.42 * l, -0.4 * w]] as Point[]).map(([u, v]) => place(u, v)), faded(edge, 0.85));
}
