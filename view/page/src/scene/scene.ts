import { Camera } from "./camera";
import { lookOf, type CandidateLook } from "./candidates";
import { layers, type Layer, type Term } from "./layers";
import { Painter } from "./painter";
import type { Rgba, Theme } from "./palette";
import type { Body, Frame, Hello, Scene } from "../protocol";
import { freeSpace } from "./solid/contours";
import { SpaceView } from "./solid/view";
import { circle, corners, dashed, drawCar, drawObstacle, drawTracked, faded, usualCar, type Point, type Pose } from "./shapes";

export interface Mark { x: number; y: number; shown: boolean }
const opponent = 4; // kind of body
const room = { top: 40, bottom: 56 }; // pixels of a lane that its title and caption cover

/** A part of the stage in which one controller is shown. */
interface Lane { camera: Camera; frame?: Frame; driven: number[] }

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
  private space?: SpaceView; // while it is needed for the first time
  isInSpace = false;
  /** The ghost is to be shown beside the car, in a lane of its own. */
  isSplit = false;
  readonly ghostCamera = new Camera();
  ghostDriven: number[] = [];
  private stage = { width: 1, height: 1, covered: this.camera.covered };
  private readonly painter: Painter;
  private readonly map: WebGLTexture;
  private readonly costMap: WebGLTexture;
  private costMapOf?: Frame;
  /** x and y (m) of the path that the car has driven, one after the other. */
  driven: number[] = [];
  /** Where the best lap was, so long after its start as the car is after its own. */
  best?: Pose;
  /** Where the car was at the time under the pointer. */
  probe?: Pose;
  private bounds: [number, number, number, number] = [-5, -5, 5, 5]; // of the course line, with room for the walls
  /** Whether the browser can draw the scene. */
  get canDraw() { return this.painter.canDraw; }
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
    if (grid) this.painter.upload(this.map, grid.width, grid.height, freeSpace(grid));
    this.space?.setScene(scene);
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
    this.space?.orbit.fit(...this.bounds);
    this.fitted = this.place();
  }
  /** Whether the camera is where `fit` put it. */
  get isFitted() { return this.fitted === this.place(); }
  private place() { const c = this.camera; if (this.isInSpace) return this.space!.orbit.place(); return c.follow === "free" ? [c.x, c.y, c.zoom].join() : "not fitted"; }
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

  get isSideBySide() { return this.isSplit && !this.isInSpace && this.frame?.ghostFrame !== undefined; }

  /** The size of the stage, and what panels cover of it (pixels). */
  setStage(width: number, height: number, covered: Camera["covered"]) {
    const fitted = this.isFitted;
    this.stage = { width, height, covered };
    this.space?.setStage(width, height, covered);
    this.lanes();
    if (fitted) this.fit();
  }

  /** Shows the scene in space or from above. Throws where the device cannot. */
  setInSpace(on: boolean) {
    const fitted = this.isFitted, { width, height, covered } = this.stage;
    if (on && !this.space) {
      this.space = new SpaceView(this.painter);
      this.space.setScene(this.scene);
    }
    this.isInSpace = on;
    this.space?.setStage(width, height, covered);
    if (fitted) this.fit();
  }

  setSplit(on: boolean) {
    const fitted = this.isFitted;
    this.isSplit = on;
    this.lanes();
    if (fitted) this.fit();
  }

  /** The lanes, with their cameras where they belong: beside one another, or one above the other on a high stage. */
  private lanes(): Lane[] {
    const { width, height, covered } = this.stage, { camera, ghostCamera, frame } = this;
    const first = { camera, frame, driven: this.driven };
    if (!this.isSideBySide) {
      Object.assign(camera, { left: 0, top: 0, width, height, covered });
      return [first];
    }
    if (width >= 0.7 * height) {
      const middle = Math.round((covered.left + width - covered.right) / 2), own = { top: 0, height }, ends = { top: covered.top + room.top, bottom: room.bottom };
      Object.assign(camera, { left: 0, width: middle, covered: { ...ends, left: covered.left, right: 0 }, ...own });
      Object.assign(ghostCamera, { left: middle, width: width - middle, covered: { ...ends, left: 0, right: covered.right }, ...own });
    } else {
      const middle = Math.round((covered.top + height) / 2), own = { left: 0, width }, sides = { left: covered.left, right: covered.right };
      Object.assign(camera, { top: 0, height: middle, covered: { ...sides, top: covered.top + room.top, bottom: room.bottom }, ...own });
      Object.assign(ghostCamera, { top: middle, height: height - middle, covered: { ...sides, ...room }, ...own });
    }
    const { x, y, zoom, turn, follow } = camera;
    Object.assign(ghostCamera, follow === "free" ? { x, y, zoom, turn, follow } : { zoom, turn, follow });
    return [first, { camera: ghostCamera, frame: frame!.ghostFrame, driven: this.ghostDriven }];
  }

  /** Whether a point of the stage lies in the ghost's lane. */
  isInGhostLane(p: { x: number; y: number }) {
    const c = this.ghostCamera;
    return this.isSideBySide && p.x >= c.left && p.y >= c.top;
  }
  /** The point of the first lane that shows the same place as a point of the ghost's lane. */
  fromGhostLane(p: { x: number; y: number }) {
    const [x, y] = this.camera.toScreen(...this.ghostCamera.toMap(p.x, p.y));
    return { x, y };
  }

  /** The place (m, map frame) under a point of the stage. */
  toMap(p: { x: number; y: number }): [number, number] { return this.isInSpace ? this.space!.orbit.toGround(p.x, p.y) : this.camera.toMap(p.x, p.y); }
  /** Where a place is seen on the stage. */
  toScreen(x: number, y: number) { return this.isInSpace ? this.space!.orbit.toScreen(x, y) : this.camera.toScreen(x, y); }
  /** Moves what is seen by pixels; in space, turns the camera around it. */
  drag(dx: number, dy: number) { if (this.isInSpace) this.space!.orbit.turn(dx, dy); else this.camera.pan(dx, dy); }
  zoomAt(x: number, y: number, factor: number) { if (this.isInSpace) this.space!.orbit.zoom(factor); else this.camera.zoomAt(x, y, factor); }
  zoom(factor: number) { this.zoomAt(this.camera.middleX, this.camera.middleY, factor); }

  private lookOf(frame: Frame): CandidateLook {
    // Both lanes have one scale.
    const look = lookOf(frame.candidates!, this.theme, this.term, frame === this.frame ? undefined : this.costRange);
    this.costRange = look.range;
    return look;
  }

  draw() {
    this.painter.begin(this.theme.ground);
    if (this.isInSpace) {
      const { frame, theme, visible, hello, driven } = this, candidates = frame?.candidates && visible.has("candidates") ? this.lookOf(frame) : undefined;
      return this.space!.draw(frame, this.map, this.camera.follow, { theme, visible, hello, driven, candidates });
    }
    for (const lane of this.lanes()) this.drawLane(lane);
  }

  private drawLane({ camera, frame, driven }: Lane) {
    const { painter, theme } = this, car = frame?.bodies.find((b) => b.kind === 0), end = frame?.plan?.at(-1);
    if (car) camera.track(car.x, car.y, car.yaw, end ? Math.hypot(end.x - car.x, end.y - car.y) : 0);
    painter.look(camera);
    this.drawMap();
    if (!frame) return;
    if (this.visible.has("costMap")) this.drawCostMap(frame);
    if (this.visible.has("path")) this.drawPath();
    if (this.visible.has("driven")) painter.polyline(driven, 0, driven.length / 2, theme.driven, 2, false);
    if (this.visible.has("candidates")) this.drawCandidates(frame);
    painter.flush();
    if (this.visible.has("spread")) this.drawSpread(frame);
    painter.flush();
    if (this.visible.has("guides")) this.drawGuides(frame);
    if (this.visible.has("scan")) this.drawScan(frame);
    painter.flush();
    for (const body of frame.bodies) {
      if (body.kind === opponent && this.visible.has("opponents")) drawCar(painter, theme, this.size, body, 0, theme.opponent, theme.carEdge);
      else if (body.kind !== 0 && body.kind !== opponent && this.visible.has("obstacles")) drawObstacle(painter, theme, body, this.selected === body.id);
    }
    if (this.visible.has("opponents")) drawTracked(painter, theme, frame.others ?? []);
    this.drawMarks();
    if (this.preview) this.drawPreview(this.preview);
    if (this.visible.has("nominal") && frame.nominal) dashed(painter, frame.nominal.xy, frame.nominal.points, theme.nominal, 1.6);
    if (this.visible.has("plan") && frame.plan) this.drawPlan(frame);
    if (frame.ghost && this.visible.has("ghost") && !this.isSideBySide) this.drawGhost(frame);
    painter.flush();
    if (this.best && this.visible.has("ghost") && frame === this.frame) this.drawOutline(this.best, this.theme.driven);
    if (this.probe) this.drawOutline(this.probe, this.theme.selected);
    if (car) drawCar(painter, theme, this.size, car, frame.scalars[this.index("steer")] ?? 0, theme.car, car.touched ? theme.collided : theme.carEdge);
    painter.flush();
  }

  private get size() { return this.hello?.car ?? usualCar; }
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
    const look = this.lookOf(frame);
    for (const i of look.order) this.painter.polyline(c.xy, i * c.points, c.points, look.colours[i], look.widths[i], false);
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

  private drawPreview(p: { x: number; y: number; kind: number }) {
    const points = p.kind === 3 ? circle(p.x, p.y, 0.15) : corners({ ...p, yaw: 0, length: p.kind === 1 ? 0.58 : 0.4, width: p.kind === 1 ? 0.31 : 0.4 });
    this.painter.outline(points, this.theme.obstacle, 1.5);
  }

  private drawOutline(at: Pose, colour: Rgba) {
    this.painter.outline(corners({ ...at, length: this.size.length, width: this.size.width }), colour, 2);
    this.painter.dot(at.x, at.y, 5, colour);
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
    dashed(this.painter, g.plan, g.plan.length / 2, faded(this.theme.ghost, 0.9), 2.4);
    this.painter.flush();
    drawCar(this.painter, this.theme, this.size, g, g.steer, faded(this.theme.ghost, 0.75), this.theme.carEdge);
  }
}
