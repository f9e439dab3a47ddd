import { Camera } from "./camera";
import { Painter } from "./painter";
import { rampColour, type Rgba, type Theme } from "./palette";
import type { Body, Frame, Hello, Scene } from "./protocol";

export const layers = [
  ["costMap", "Cost map", "where the rear axle would mean a collision, from the scan"],
  ["path", "Course line", "the line to follow"],
  ["scan", "LiDAR", "end points of the scan"],
  ["candidates", "Candidates", "sampled control sequences, coloured by cost"],
  ["guides", "Guides", "guide particles and how the solver moved them"],
  ["nominal", "Nominal", "the sequence around which samples are weighted"],
  ["plan", "Plan", "the sequence that is sent to the car"],
  ["spread", "Spread", "two standard deviations of the plan, from the solver's covariance"],
  ["driven", "Driven line", "the path of the car"],
  ["obstacles", "Obstacles", "parked cars, boxes and poles"],
  ["opponents", "Opponents", "cars that follow the course line"],
  ["modes", "Caption", "which way around the next obstacle the samples and the plan take"],
  ["ghost", "Ghost", "the second controller, in a world of its own"],
] as const;
export type Layer = (typeof layers)[number][0];
export const terms = ["distance", "yaw", "collision", "total"] as const;
export type Term = (typeof terms)[number];

type Point = [number, number];
export interface Mark { x: number; y: number; shown: boolean }
const opponent = 4; // kind of body

export function corners(b: { x: number; y: number; yaw: number; length: number; width: number }): Point[] {
  const c = Math.cos(b.yaw), s = Math.sin(b.yaw), l = b.length / 2, w = b.width / 2;
  return ([[l, w], [-l, w], [-l, -w], [l, -w]] as Point[]).map(([u, v]) => [b.x + c * u - s * v, b.y + s * u + c * v]);
}
function circle(x: number, y: number, radius: number, n = 28): Point[] {
  return Array.from({ length: n }, (_, i) => [x + radius * Math.cos((2 * Math.PI * i) / n), y + radius * Math.sin((2 * Math.PI * i) / n)]);
}
/** The mean over 3 x 3 cells, so that the border between free and occupied is drawn as a line and not as stairs. */
function smoothed(cells: Uint8Array, width: number, height: number): Uint8Array {
  const rows = new Uint16Array(cells.length), out = new Uint8Array(cells.length);
  for (let i = 1; i + 1 < cells.length; ++i) rows[i] = cells[i - 1] + cells[i] + cells[i + 1];
  for (let i = width; i < width * (height - 1); ++i) out[i] = Math.round((rows[i - width] + rows[i] + rows[i + width]) / 9);
  return out;
}
const faded = (c: Rgba, by: number): Rgba => [c[0], c[1], c[2], c[3] * by];

/** Draws what the controller considers. */
export class SceneView {
  readonly camera = new Camera();
  readonly visible = new Set<Layer>(layers.map(([name]) => name));
  term: Term = "total";
  theme: Theme;
  selected = -1;
  hello?: Hello;
  frame?: Frame;
  costRange: [number, number] = [0, 1];
  private scene: Scene = {};
  private readonly painter: Painter;
  private readonly map: WebGLTexture;
  private readonly costMap: WebGLTexture;
  private costMapOf?: Frame;
  /** x and y (m) of the path that the car has driven, one after the other. */
  driven: number[] = [];
  /** Where the car was at the time under the pointer. */
  probe?: { x: number; y: number; yaw: number };
  private bounds: [number, number, number, number] = [-5, -5, 5, 5]; // of the course line, with room for the walls
  get courseBounds() { return this.bounds; }
  marks: Mark[] = []; // collisions of an evaluation
  preview?: { x: number; y: number; kind: number };

  constructor(canvas: HTMLCanvasElement, theme: Theme) {
    this.painter = new Painter(canvas);
    this.theme = theme;
    this.map = this.painter.texture();
    this.costMap = this.painter.texture();
  }

  setScene(scene: Scene) {
    this.scene = scene;
    const grid = scene.grid;
    if (grid) this.painter.upload(this.map, grid.width, grid.height, smoothed(grid.cells.map((v) => (v === 0 ? 255 : 0)), grid.width, grid.height));
    const p = scene.path?.xyv;
    if (p) {
      let [x0, y0, x1, y1] = [Infinity, Infinity, -Infinity, -Infinity];
      for (let i = 0; i < p.length; i += 3) {
        x0 = Math.min(x0, p[i]); x1 = Math.max(x1, p[i]);
        y0 = Math.min(y0, p[i + 1]); y1 = Math.max(y1, p[i + 1]);
      }
      this.bounds = [x0 - 1.5, y0 - 1.5, x1 + 1.5, y1 + 1.5];
    }
  }

  /** The pose (m, m, rad) on the course line after an arc length (m). */
  alongPath(length: number): [number, number, number] {
    const p = this.scene.path?.xyv ?? new Float32Array(6), at = (k: number): Point => [p[3 * k], p[3 * k + 1]];
    let k = 0;
    for (let s = 0; 3 * k + 6 < p.length && s < length; ++k) s += Math.hypot(p[3 * k + 3] - p[3 * k], p[3 * k + 4] - p[3 * k + 1]);
    const [x, y] = at(k), [nx, ny] = at(k + 1);
    return [x, y, Math.atan2(ny - y, nx - x)];
  }

  fit() {
    this.camera.fit(...this.bounds);
    this.fitted = this.place();
  }
  /** Whether the camera is where `fit` put it. */
  get isFitted() { return this.fitted === this.place(); }
  private place() { const c = this.camera; return c.follow === "free" ? [c.x, c.y, c.zoom].join() : "not fitted"; }
  private fitted = "";

  /** The body under a point of the map frame; the driven car is 0. */
  bodyAt(x: number, y: number): Body | undefined {
    const slack = 6 / this.camera.zoom;
    for (const b of [...(this.frame?.bodies ?? [])].reverse()) {
      const c = Math.cos(b.yaw), s = Math.sin(b.yaw), dx = x - b.x, dy = y - b.y;
      if (Math.abs(c * dx + s * dy) <= b.length / 2 + slack && Math.abs(-s * dx + c * dy) <= b.width / 2 + slack) return b;
    }
    return undefined;
  }

  draw() {
    const { painter, camera, theme, frame } = this;
    const car = frame?.bodies.find((b) => b.kind === 0);
    const end = frame?.plan?.at(-1);
    if (car) camera.track(car.x, car.y, car.yaw, end ? Math.hypot(end.x - car.x, end.y - car.y) : 0);
    painter.begin(camera, theme.ground);
    this.drawMap();
    if (!frame) return;
    if (this.visible.has("costMap")) this.drawCostMap(frame);
    if (this.visible.has("path")) this.drawPath();
    if (this.visible.has("driven")) painter.polyline(this.driven, 0, this.driven.length / 2, theme.driven, 2, false);
    if (this.visible.has("candidates")) this.drawCandidates(frame);
    painter.flush();
    if (this.visible.has("spread")) this.drawSpread(frame);
    painter.flush();
    if (this.visible.has("guides")) this.drawGuides(frame);
    if (this.visible.has("scan")) this.drawScan(frame);
    painter.flush();
    for (const body of frame.bodies) {
      if (body.kind === opponent && this.visible.has("opponents")) this.drawCar(body.x, body.y, body.yaw, 0, theme.opponent, theme.carEdge, 1);
      else if (body.kind !== 0 && body.kind !== opponent && this.visible.has("obstacles")) this.drawObstacle(body);
    }
    this.drawMarks();
    if (this.preview) this.drawPreview(this.preview);
    if (this.visible.has("nominal") && frame.nominal) this.dashed(frame.nominal.xy, frame.nominal.points, theme.nominal, 1.6);
    if (this.visible.has("plan") && frame.plan) this.drawPlan(frame);
    if (frame.ghost && this.visible.has("ghost")) this.drawGhost(frame);
    painter.flush();
    if (this.probe) this.drawProbe(this.probe);
    if (car) this.drawCar(car.x, car.y, car.yaw, frame.scalars[this.index("steer")] ?? 0, theme.car, car.touched ? theme.collided : theme.carEdge, 1);
    painter.flush();
  }

  private index(name: string) { return this.hello?.scalars.indexOf(name) ?? -1; }

  private drawMap() {
    const grid = this.scene.grid, { theme } = this;
    if (!grid) return;
    this.painter.cells(this.map, grid.x, grid.y, grid.yaw, grid.width * grid.resolution, grid.height * grid.resolution, theme.free, theme.wall, theme.wallEdge, 0.6);
  }

  private drawCostMap(frame: Frame) {
    const m = frame.costMap;
    if (!m) return;
    if (this.costMapOf !== frame) {
      // Cells come with the largest x and y first; the texture begins with the smallest, x along a row.
      const turned = new Uint8Array(m.cells.length);
      for (let r = 0; r < m.rows; ++r)
        for (let c = 0; c < m.columns; ++c) turned[(m.columns - 1 - c) * m.rows + (m.rows - 1 - r)] = m.cells[r * m.columns + c];
      this.painter.upload(this.costMap, m.rows, m.columns, turned);
      this.costMapOf = frame;
    }
    const lx = m.rows * m.resolution, ly = m.columns * m.resolution, c = Math.cos(m.yaw), s = Math.sin(m.yaw);
    const u = m.centerX - lx / 2, v = m.centerY - ly / 2;
    this.painter.cells(this.costMap, m.x + c * u - s * v, m.y + s * u + c * v, m.yaw, lx, ly, this.theme.cost, [0, 0, 0, 0], [0, 0, 0, 0], 0);
  }

  private drawPath() {
    const path = this.scene.path;
    if (!path) return;
    const p = path.xyv, n = p.length / 3, colour = this.theme.path;
    for (let i = 0; i < (path.closed ? n : n - 1); ++i) {
      if (i % 4 >= 2) continue;
      const j = (i + 1) % n;
      this.painter.segment(p[3 * i], p[3 * i + 1], p[3 * j], p[3 * j + 1], colour, 1.3, false);
    }
  }

  private drawCandidates(frame: Frame) {
    const c = frame.candidates;
    if (!c) return;
    const { theme } = this, k = terms.indexOf(this.term);
    const value = (i: number) => (k < 3 ? c.terms[5 * i + k] : c.terms[5 * i + 3]);
    const free = Array.from({ length: c.count }, (_, i) => i).filter((i) => !c.collided[i] || k === 2);
    const sorted = free.map(value).filter(Number.isFinite).sort((a, b) => a - b);
    // The worst tenth shares the end of the scale, so that the many good ones can be told apart.
    const low = sorted[0] ?? 0, high = Math.max(low + 1e-9, sorted[Math.floor(0.9 * (sorted.length - 1))] ?? 1);
    this.costRange = [low, high];
    const order = Array.from({ length: c.count }, (_, i) => i).sort((a, b) => (c.collided[b] - c.collided[a]) || value(b) - value(a));
    // Their number is small where the weight is concentrated, so a share of the largest weight is shown.
    const heaviest = Math.max(1e-12, ...Array.from({ length: c.count }, (_, i) => c.terms[5 * i + 4]));
    for (const i of order) {
      const share = Math.sqrt(c.terms[5 * i + 4] / heaviest);
      const t = Math.min(1, Math.max(0, (value(i) - low) / (high - low)));
      const colour = c.collided[i] ? theme.collided : rampColour(theme, t, 0.5 - 0.25 * t + 0.5 * share);
      this.painter.polyline(c.xy, i * c.points, c.points, colour, c.collided[i] ? 1 : 1 + 2 * share, false);
    }
  }

  private drawGuides(frame: Frame) {
    const g = frame.guides;
    if (!g) return;
    const { theme } = this;
    for (let k = 0; k < g.iterations; ++k) {
      const last = k === g.iterations - 1, share = (k + 1) / g.iterations;
      for (let i = 0; i < g.guides; ++i) {
        const from = (k * g.guides + i) * g.points;
        this.painter.polyline(g.xy, from, g.points, faded(theme.guide, last ? 1 : 0.1 + 0.3 * share), last ? 2 : 1, false);
        const end = from + g.points - 1;
        this.painter.dot(g.xy[2 * end], g.xy[2 * end + 1], last ? 6 : 3, faded(theme.guide, last ? 1 : 0.55));
        if (k > 0) {
          const before = ((k - 1) * g.guides + i + 1) * g.points - 1;
          this.painter.segment(g.xy[2 * before], g.xy[2 * before + 1], g.xy[2 * end], g.xy[2 * end + 1], faded(theme.guide, 0.8), 1.2, false);
        }
      }
    }
  }

  private drawSpread(frame: Frame) {
    const plan = frame.plan;
    if (!plan || plan.length < 2) return;
    for (let i = 1; i < plan.length; ++i) {
      const a = plan[i - 1], b = plan[i], edge = (p: typeof a, side: number): Point => [p.x - side * 2 * p.spread * Math.sin(p.yaw), p.y + side * 2 * p.spread * Math.cos(p.yaw)];
      this.painter.convex([edge(a, 1), edge(b, 1), edge(b, -1), edge(a, -1)], this.theme.spread);
    }
  }

  private drawPlan(frame: Frame) {
    const plan = frame.plan!, { theme } = this;
    for (let i = 1; i < plan.length; ++i) this.painter.segment(plan[i - 1].x, plan[i - 1].y, plan[i].x, plan[i].y, theme.plan, 3.2);
    for (const p of plan) this.painter.dot(p.x, p.y, 5, theme.plan);
  }

  private drawScan(frame: Frame) {
    const scan = frame.scan, lidar = this.hello?.lidar;
    if (!scan || !lidar) return;
    const most = lidar.range_max * 1000 - 5;
    for (let i = 0; i < scan.ranges.length; ++i) {
      if (scan.ranges[i] >= most) continue;
      const r = scan.ranges[i] / 1000, a = scan.yaw + lidar.angle_min + i * lidar.angle_increment;
      this.painter.dot(scan.x + r * Math.cos(a), scan.y + r * Math.sin(a), 2.6, this.theme.scan);
    }
  }

  private dashed(xy: Float32Array, count: number, colour: Rgba, width: number) {
    for (let i = 0; i < count - 1; i += 2) this.painter.segment(xy[2 * i], xy[2 * i + 1], xy[2 * i + 2], xy[2 * i + 3], colour, width, false);
  }

  private drawObstacle(b: Body) {
    const { painter, theme } = this;
    const points = b.kind === 3 ? circle(b.x, b.y, b.length / 2) : corners(b);
    painter.convex(points, b.touched ? [...theme.collided.slice(0, 3), 1] as unknown as Rgba : theme.obstacle);
    painter.flush();
    painter.outline(points, this.selected === b.id ? theme.selected : theme.obstacleEdge, this.selected === b.id ? 2.5 : 1.2);
    if (b.kind === 1) {
      const front = corners({ ...b, length: b.length * 0.24, width: b.width * 0.8, x: b.x + 0.12 * b.length * Math.cos(b.yaw), y: b.y + 0.12 * b.length * Math.sin(b.yaw) });
      painter.outline(front, faded(theme.obstacleEdge, 0.7), 1);
    }
    painter.flush();
  }

  private drawPreview(p: { x: number; y: number; kind: number }) {
    const points = p.kind === 3 ? circle(p.x, p.y, 0.15) : corners({ ...p, yaw: 0, length: p.kind === 1 ? 0.58 : 0.4, width: p.kind === 1 ? 0.31 : 0.4 });
    this.painter.outline(points, this.theme.obstacle, 1.5);
  }

  private drawProbe(at: { x: number; y: number; yaw: number }) {
    const size = this.hello?.car ?? { length: 0.58, width: 0.31 };
    this.painter.outline(corners({ ...at, length: size.length, width: size.width }), this.theme.selected, 2);
    this.painter.dot(at.x, at.y, 5, this.theme.selected);
  }

  private drawMarks() {
    for (const m of this.marks) {
      const r = (m.shown ? 9 : 5) / this.camera.zoom, colour = m.shown ? this.theme.selected : this.theme.mark;
      this.painter.segment(m.x - r, m.y - r, m.x + r, m.y + r, colour, m.shown ? 3.5 : 2.2);
      this.painter.segment(m.x - r, m.y + r, m.x + r, m.y - r, colour, m.shown ? 3.5 : 2.2);
    }
  }

  /** The mark under a point of the map frame. */
  markAt<M extends Mark>(marks: M[], x: number, y: number): M | undefined {
    const within = marks.map((m) => ({ m, d: Math.hypot(m.x - x, m.y - y) })).filter(({ d }) => d < 10 / this.camera.zoom);
    return within.sort((a, b) => a.d - b.d)[0]?.m;
  }

  private drawGhost(frame: Frame) {
    const g = frame.ghost!;
    this.dashed(g.plan, g.plan.length / 2, faded(this.theme.ghost, 0.9), 2.4);
    this.painter.flush();
    this.drawCar(g.x, g.y, g.yaw, g.steer, faded(this.theme.ghost, 0.75), this.theme.carEdge, 0.9);
  }

  private drawCar(x: number, y: number, yaw: number, steer: number, body: Rgba, edge: Rgba, alpha: number) {
    const size = this.hello?.car ?? { length: 0.58, width: 0.31, front: 0.159, rear: 0.171 };
    const { painter, theme } = this, c = Math.cos(yaw), s = Math.sin(yaw);
    const place = (u: number, v: number): Point => [x + c * u - s * v, y + s * u + c * v];
    const l = size.length / 2, w = size.width / 2;
    for (const [along, turn] of [[size.front, steer], [-size.rear, 0]]) {
      for (const side of [-1, 1]) {
        const [wx, wy] = place(along, side * w * 0.86);
        painter.convex(corners({ x: wx, y: wy, yaw: yaw + turn, length: 0.13, width: 0.055 }), faded(theme.wheel, alpha));
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
}
