import { page } from "../page";
import type { CostMap, Grid, Guides, Path, PlanState, Scan } from "../protocol";
import { theme } from "../theme";
import { imageOf, packed, type Painter } from "./painter";
import type { Rgba, Theme } from "./palette";
import { faded, placed, type Point } from "./shapes";

const mapPixels = 6e6; // pixels of the image of a map at most
const rim = 0.6; // half the width of the line around the free space, in pixels of the image

/** The free cells of a grid as 1, all others as 0, each the mean over 3 x 3 cells, for a smooth border. */
function freeSpace({ cells, width, height }: Grid): Float32Array {
  const free = cells.map((v) => (v === 0 ? 1 : 0));
  const out = new Float32Array(free.length);
  for (let i = width + 1; i < width * (height - 1) - 1; ++i)
    for (const row of [i - width, i, i + width]) out[i] += (free[row - 1] + free[row] + free[row + 1]) / 9;
  return out;
}

/** A map as an image, finer than its cells. */
function mapImage(grid: Grid): HTMLCanvasElement {
  const { width, height } = grid;
  const free = freeSpace(grid);
  const fine = Math.min(4, Math.max(1, Math.floor(Math.sqrt(mapPixels / (width * height)))));
  const [within, beyond] = [packed(theme.free), packed(theme.wall)];
  const mix = (a: Rgba, b: Rgba, share: number) => a.map((v, k) => v + share * (b[k] - v)) as Rgba;
  return imageOf(width * fine, height * fine, (px, py) => {
    const x = Math.min(width - 1.001, Math.max(0, (px + 0.5) / fine - 0.5));
    const y = Math.min(height - 1.001, Math.max(0, (py + 0.5) / fine - 0.5));
    const i = Math.floor(y) * width + Math.floor(x);
    const [u, v] = [x % 1, y % 1];
    const below = free[i] + u * (free[i + 1] - free[i]);
    const above = free[i + width] + u * (free[i + width + 1] - free[i + width]);
    const inside = 3 * fine * (below + v * (above - below) - 0.5); // pixels from a straight border
    if (Math.abs(inside) > rim + 1) return inside > 0 ? within : beyond;
    const edge = Math.min(1, rim + 1 - Math.abs(inside));
    return packed(mix(inside > 0 ? theme.free : theme.wall, theme.wallEdge, edge));
  });
}

let map: { grid: Grid; theme: Theme; image: HTMLCanvasElement } | undefined;
/** Draws a map with an image that is made once for each map and theme. */
export function drawMap(painter: Painter, grid: Grid) {
  if (map?.grid !== grid || map.theme !== theme) map = { grid, theme, image: mapImage(grid) };
  painter.image(map.image, grid, grid.width * grid.resolution, grid.height * grid.resolution);
}

export function drawCostMap(painter: Painter, map: CostMap) {
  const { rows, columns, resolution, bits } = map;
  const cost = packed(theme.cost);
  // The image begins with the smallest x and y, with x along a row.
  const image = imageOf(rows, columns, (x, y) => {
    const i = (rows - 1 - x) * columns + (columns - 1 - y);
    return bits[i >> 3] & (1 << (i & 7)) ? cost : 0;
  });
  const [width, height] = [rows * resolution, columns * resolution];
  const [[x, y]] = placed(map, [[map.centerX - width / 2, map.centerY - height / 2]]);
  painter.image(image, { x, y, yaw: map.yaw }, width, height);
}

export function drawPath(painter: Painter, { xyv, closed }: Path) {
  const n = xyv.length / 3;
  for (let i = 0; i < (closed ? n : n - 1); ++i) {
    if (i % 4 >= 2) continue;
    const j = (i + 1) % n;
    painter.segment(xyv[3 * i], xyv[3 * i + 1], xyv[3 * j], xyv[3 * j + 1], theme.path, 1.3);
  }
}

/** Lines to follow. */
export function drawLines(painter: Painter, lines: Float32Array[]) {
  for (const xy of lines) painter.dashed(xy, xy.length / 2, theme.path, 1.3);
}

/** The guide particles in all iterations, and how their ends moved; the last iteration is bright. */
export function drawGuides(painter: Painter, { guides, iterations, points, xy }: Guides) {
  for (let k = 0; k < iterations; ++k) {
    const last = k === iterations - 1;
    const line = faded(theme.guide, last ? 1 : 0.1 + (0.3 * (k + 1)) / iterations);
    for (let i = 0; i < guides; ++i) {
      const from = (k * guides + i) * points;
      const end = from + points - 1;
      painter.polyline(xy, from, points, line, last ? 2 : 1);
      painter.dot(xy[2 * end], xy[2 * end + 1], last ? 6 : 3, faded(theme.guide, last ? 1 : 0.55));
      if (k === 0) continue;
      const before = end - guides * points;
      const [x0, y0, x1, y1] = [xy[2 * before], xy[2 * before + 1], xy[2 * end], xy[2 * end + 1]];
      painter.segment(x0, y0, x1, y1, faded(theme.guide, 0.8), 1.2);
    }
  }
}

/** Two standard deviations to either side of the plan. */
export function drawSpread(painter: Painter, plan: PlanState[]) {
  const edge = (p: PlanState, side: number): Point => [
    p.x - side * 2 * p.spread * Math.sin(p.yaw),
    p.y + side * 2 * p.spread * Math.cos(p.yaw),
  ];
  const left = plan.map((p) => edge(p, 1));
  const right = plan.map((p) => edge(p, -1));
  painter.fill([...left, ...right.reverse()], theme.spread);
}

export function drawPlan(painter: Painter, plan: PlanState[]) {
  const xy = plan.flatMap((p) => [p.x, p.y]);
  painter.polyline(xy, 0, plan.length, theme.plan, 3.2);
  for (const p of plan) painter.dot(p.x, p.y, 5, theme.plan);
}

export function drawScan(painter: Painter, scan: Scan) {
  const { lidar } = page.hello!;
  if (!lidar) return;
  const most = lidar.range_max * 1000 - 5;
  const points: Point[] = [];
  for (const [i, range] of scan.ranges.entries()) {
    if (range >= most) continue;
    const r = range / 1000;
    const angle = scan.yaw + lidar.angle_min + i * lidar.angle_increment;
    points.push([scan.x + r * Math.cos(angle), scan.y + r * Math.sin(angle)]);
  }
  painter.dots(points, 2.4, theme.scan);
}
