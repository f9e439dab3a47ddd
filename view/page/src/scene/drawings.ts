import type { CostMap, Frame, Grid, Guides, Hello, Path, PlanState, Scan } from "../protocol";
import type { CandidateLook } from "./candidates";
import type { Painter } from "./painter";
import type { Rgba, Theme } from "./palette";
import { faded, type Point } from "./shapes";

/** The free cells of a grid as 255, all others as 0, each the mean over 3 x 3 cells, for a smooth border. */
export function freeSpace({ cells, width, height }: Grid): Uint8Array {
  const free = cells.map((v) => (v === 0 ? 255 : 0));
  const rows = new Uint16Array(free.length);
  const out = new Uint8Array(free.length);
  for (let i = 1; i + 1 < free.length; ++i) rows[i] = free[i - 1] + free[i] + free[i + 1];
  for (let i = width; i < width * (height - 1); ++i)
    out[i] = Math.round((rows[i - width] + rows[i] + rows[i + width]) / 9);
  return out;
}

export function drawMap(painter: Painter, theme: Theme, texture: WebGLTexture, grid: Grid) {
  const { x, y, yaw, resolution } = grid;
  const place = { x, y, yaw, width: grid.width * resolution, height: grid.height * resolution };
  painter.cells(texture, place, { inside: theme.free, outside: theme.wall, edge: theme.wallEdge }, 0.6);
}

/** The cells of a cost map as a texture: from the smallest x and y, with x along a row. */
export function costMapTexture({ rows, columns, cells }: CostMap): Uint8Array {
  const turned = new Uint8Array(cells.length);
  for (let r = 0; r < rows; ++r)
    for (let c = 0; c < columns; ++c)
      turned[(columns - 1 - c) * rows + (rows - 1 - r)] = cells[r * columns + c];
  return turned;
}

export function drawCostMap(painter: Painter, theme: Theme, texture: WebGLTexture, map: CostMap) {
  const { x, y, yaw, resolution } = map;
  const width = map.rows * resolution;
  const height = map.columns * resolution;
  const u = map.centerX - width / 2;
  const v = map.centerY - height / 2;
  const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
  const place = { x: x + c * u - s * v, y: y + s * u + c * v, yaw, width, height };
  const none: Rgba = [0, 0, 0, 0];
  painter.cells(texture, place, { inside: theme.cost, outside: none, edge: none }, 0);
}

export function drawPath(painter: Painter, theme: Theme, { xyv, closed }: Path) {
  const n = xyv.length / 3;
  for (let i = 0; i < (closed ? n : n - 1); ++i) {
    if (i % 4 >= 2) continue;
    const j = (i + 1) % n;
    painter.segment(xyv[3 * i], xyv[3 * i + 1], xyv[3 * j], xyv[3 * j + 1], theme.path, 1.3, false);
  }
}

export function drawCandidates(painter: Painter, { candidates }: Frame, look: CandidateLook) {
  if (!candidates) return;
  const { xy, points } = candidates;
  for (const i of look.order)
    painter.polyline(xy, i * points, points, look.colours[i], look.widths[i], false);
}

/** The guide particles in all iterations, and how their ends moved; the last iteration is bright. */
export function drawGuides(painter: Painter, theme: Theme, { guides, iterations, points, xy }: Guides) {
  for (let k = 0; k < iterations; ++k) {
    const last = k === iterations - 1;
    const line = faded(theme.guide, last ? 1 : 0.1 + (0.3 * (k + 1)) / iterations);
    for (let i = 0; i < guides; ++i) {
      const from = (k * guides + i) * points;
      const end = from + points - 1;
      painter.polyline(xy, from, points, line, last ? 2 : 1, false);
      painter.dot(xy[2 * end], xy[2 * end + 1], last ? 6 : 3, faded(theme.guide, last ? 1 : 0.55));
      if (k === 0) continue;
      const before = end - guides * points;
      const [x0, y0, x1, y1] = [xy[2 * before], xy[2 * before + 1], xy[2 * end], xy[2 * end + 1]];
      painter.segment(x0, y0, x1, y1, faded(theme.guide, 0.8), 1.2, false);
    }
  }
}

/** Two standard deviations to either side of the plan. */
export function drawSpread(painter: Painter, theme: Theme, plan: PlanState[]) {
  const edge = (p: PlanState, side: number): Point => [
    p.x - side * 2 * p.spread * Math.sin(p.yaw),
    p.y + side * 2 * p.spread * Math.cos(p.yaw),
  ];
  for (let i = 1; i < plan.length; ++i) {
    const [a, b] = [plan[i - 1], plan[i]];
    painter.convex([edge(a, 1), edge(b, 1), edge(b, -1), edge(a, -1)], theme.spread);
  }
}

export function drawPlan(painter: Painter, theme: Theme, plan: PlanState[]) {
  for (let i = 1; i < plan.length; ++i)
    painter.segment(plan[i - 1].x, plan[i - 1].y, plan[i].x, plan[i].y, theme.plan, 3.2);
  for (const p of plan) painter.dot(p.x, p.y, 5, theme.plan);
}

export function drawScan(painter: Painter, theme: Theme, scan: Scan, lidar: Hello["lidar"]) {
  const most = lidar.range_max * 1000 - 5;
  for (const [i, range] of scan.ranges.entries()) {
    if (range >= most) continue;
    const r = range / 1000;
    const angle = scan.yaw + lidar.angle_min + i * lidar.angle_increment;
    painter.dot(scan.x + r * Math.cos(angle), scan.y + r * Math.sin(angle), 2.6, theme.scan);
  }
}
