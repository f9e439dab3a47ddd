import type { Painter } from "../painter";
import type { CandidateLook } from "../candidates";
import type { Rgba, Theme } from "../palette";
import type { Camera, Follow } from "../camera";
import type { Body, Frame, Hello, Scene } from "../../protocol";
import { circle, corners, faded, usualCar, type CarSize, type Point, type Pose } from "../shapes";
import type { Layer } from "../layers";
import { border, freeSpace } from "./contours";
import { Orbit } from "./orbit";
import { Lines, Renderer, Solids, type Mesh } from "./renderer";

const heights = { wall: 0.32, box: 0.3, pole: 0.45, car: 0.14 }; // m
const lift = { path: 0.012, scan: 0.08, candidates: 0.02, guides: 0.03, nominal: 0.035, plan: 0.045, driven: 0.015, ghost: 0.03 }; // m above the ground

/** What is drawn, and how. */
export interface Look { theme: Theme; visible: Set<Layer>; hello?: Hello; driven: number[]; candidates?: CandidateLook }

/** The scene in space, from a camera that follows the car or stands still. */
export class SpaceView {
  readonly orbit = new Orbit();
  private readonly renderer: Renderer;
  private walls?: Mesh;
  private bodies?: Mesh;
  private segments: Float32Array = new Float32Array(0);
  private wallsOf?: Theme;
  private scene: Scene = {};
  private followed: Follow = "free";

  constructor(private readonly painter: Painter) {
    this.renderer = new Renderer(painter.gl, (vertex, fragment) => painter.compile(vertex, fragment).program);
  }

  setScene(scene: Scene) {
    this.scene = scene;
    this.segments = scene.grid ? border(scene.grid, freeSpace(scene.grid)) : new Float32Array(0);
    this.wallsOf = undefined;
  }

  setStage(width: number, height: number, covered: Camera["covered"]) {
    Object.assign(this.orbit, { width, height, aside: [(covered.left - covered.right) / 2, (covered.top - covered.bottom) / 2], free: [Math.max(60, width - covered.left - covered.right), Math.max(60, height - covered.top - covered.bottom)] });
  }

  /** Keeps the camera with the car: behind it, or looking in one direction. */
  private track(car: Pose, follow: Follow) {
    const { orbit } = this;
    if (follow !== this.followed) {
      if (this.followed === "free") Object.assign(orbit, { distance: 4.2, pitch: 0.42, azimuth: follow === "heading" ? 0 : car.yaw, heading: 0 });
      else if (follow === "heading") orbit.azimuth = 0;
      else orbit.azimuth += orbit.heading;
      this.followed = follow;
    }
    if (follow !== "free") orbit.target = [car.x + 0.8 * Math.cos(car.yaw), car.y + 0.8 * Math.sin(car.yaw), 0.1];
    orbit.heading = follow === "heading" ? car.yaw : 0;
  }

  draw(frame: Frame | undefined, map: WebGLTexture, follow: Follow, look: Look) {
    const { renderer, orbit } = this, { grid } = this.scene, { theme } = look, gl = this.painter.gl;
    if (frame?.bodies[0]) this.track(frame.bodies[0], follow);
    gl.viewport(0, 0, this.painter.canvas.width, this.painter.canvas.height);
    gl.disable(gl.SCISSOR_TEST);
    renderer.begin(orbit, theme.ground);
    if (grid) renderer.ground(map, grid.x, grid.y, grid.yaw, grid.width * grid.resolution, grid.height * grid.resolution, theme.free, theme.wall);
    this.drawWalls(theme);
    if (frame) {
      this.drawBodies(frame, look);
      this.drawLines(frame, look);
    }
    renderer.end();
  }

  private drawWalls(theme: Theme) {
    if (this.wallsOf !== theme) {
      const s = this.segments, solids = new Solids(s.length ? [s[0], s[1], 0] : [0, 0, 0]), top = heights.wall;
      const colour: Rgba = theme.dark ? [0.33, 0.4, 0.5, 1] : [0.62, 0.68, 0.76, 1];
      for (let i = 0; i < s.length; i += 4) solids.quad([s[i], s[i + 1], 0], [s[i + 2], s[i + 3], 0], [s[i + 2], s[i + 3], top], [s[i], s[i + 1], top], colour);
      this.walls = this.renderer.mesh(solids, this.walls);
      this.wallsOf = theme;
    }
    if (this.walls) this.renderer.draw(this.walls);
    const lines = new Lines(this.orbit.target), s = this.segments;
    for (let i = 0; i < s.length; i += 4) lines.segment([s[i], s[i + 1], heights.wall], [s[i + 2], s[i + 3], heights.wall], theme.wallEdge, 1.2);
    this.renderer.lines(lines);
  }

  private drawBodies(frame: Frame, { theme, visible, hello }: Look) {
    const solids = new Solids(this.orbit.target), size = hello?.car ?? usualCar;
    const steer = frame.scalars[hello?.scalars.indexOf("steer") ?? -1] || 0;
    for (const body of frame.bodies) {
      if (body.kind === 0) car(solids, body, size, steer, body.touched ? solid(theme.collided) : theme.car, theme);
      else if (body.kind === 4) { if (visible.has("opponents")) car(solids, body, size, 0, theme.opponent, theme); }
      else if (visible.has("obstacles")) obstacle(solids, body, size, body.touched ? solid(theme.collided) : theme.obstacle, theme);
    }
    if (frame.ghost && visible.has("ghost")) car(solids, frame.ghost, size, frame.ghost.steer, solid(theme.ghost), theme);
    this.bodies = this.renderer.mesh(solids, this.bodies);
    this.renderer.draw(this.bodies);
  }

  private drawLines(frame: Frame, { theme, visible, hello, driven, candidates }: Look) {
    const lines = new Lines(this.orbit.target), { path } = this.scene;
    if (path && visible.has("path")) {
      const p = path.xyv, n = p.length / 3;
      for (let i = 0; i < (path.closed ? n : n - 1); ++i) if (i % 4 < 2) lines.segment([p[3 * i], p[3 * i + 1], lift.path], [p[(3 * i + 3) % p.length], p[(3 * i + 4) % p.length], lift.path], theme.path, 1.3);
    }
    if (visible.has("driven")) lines.polyline(driven, 0, driven.length / 2, lift.driven, theme.driven, 2.4);
    const c = frame.candidates;
    if (c) for (const i of candidates?.order ?? []) lines.polyline(c.xy, i * c.points, c.points, lift.candidates, candidates!.colours[i], candidates!.widths[i]);
    const g = frame.guides;
    if (g && visible.has("guides")) for (let i = g.count - g.guides; i < g.count; ++i) lines.polyline(g.xy, i * g.points, g.points, lift.guides, theme.guide, 2);
    const scan = frame.scan, lidar = hello?.lidar;
    if (scan && lidar && visible.has("scan")) {
      for (let i = 0; i < scan.ranges.length; ++i) {
        if (scan.ranges[i] >= lidar.range_max * 1000 - 5) continue;
        const r = scan.ranges[i] / 1000 - 0.02, a = scan.yaw + lidar.angle_min + i * lidar.angle_increment, x = scan.x + r * Math.cos(a), y = scan.y + r * Math.sin(a);
        lines.segment([x, y, lift.scan], [x, y, lift.scan], theme.scan, 2.6);
      }
    }
    if (visible.has("opponents")) for (const { xy, points, weights } of frame.others ?? []) for (const [k, weight] of weights.entries())
      for (let i = k * points; i < (k + 1) * points; ++i) lines.segment([xy[2 * i], xy[2 * i + 1], lift.nominal], [xy[2 * i], xy[2 * i + 1], lift.nominal], faded(theme.opponent, 0.15 + 0.85 * weight), 4);
    if (frame.nominal && visible.has("nominal")) for (let i = 0; i + 1 < frame.nominal.points; i += 2) lines.polyline(frame.nominal.xy, i, 2, lift.nominal, theme.nominal, 1.6);
    if (frame.ghost && visible.has("ghost")) for (let i = 0; i + 1 < frame.ghost.plan.length / 2; i += 2) lines.polyline(frame.ghost.plan, i, 2, lift.ghost, faded(theme.ghost, 0.9), 2.6);
    const plan = frame.plan;
    if (plan && visible.has("plan")) {
      lines.polyline(plan.flatMap((p) => [p.x, p.y]), 0, plan.length, lift.plan, theme.plan, 3.6);
      for (const p of plan) lines.segment([p.x, p.y, lift.plan], [p.x, p.y, lift.plan], theme.plan, 6);
    }
    this.renderer.lines(lines);
  }
}

const solid = (c: Rgba): Rgba => [c[0], c[1], c[2], 1];

/** A car with its wheels; those in front are turned by `steer` (rad). */
function car(to: Solids, at: Pose, size: CarSize, steer: number, colour: Rgba, theme: Theme) {
  const c = Math.cos(at.yaw), s = Math.sin(at.yaw), l = size.length / 2, w = size.width / 2;
  const place = ([u, v]: Point): Point => [at.x + c * u - s * v, at.y + s * u + c * v];
  for (const [along, turn] of [[size.front, steer], [-size.rear, 0]]) {
    for (const side of [-1, 1]) {
      const [x, y] = place([along, side * w * 0.86]);
      to.prism(corners({ x, y, yaw: at.yaw + turn, length: 0.13, width: 0.06 }), 0, 0.11, theme.wheel);
    }
  }
  const body = ([[-l, -0.78 * w], [0.8 * l, -0.72 * w], [l, -0.4 * w], [l, 0.4 * w], [0.8 * l, 0.72 * w], [-l, 0.78 * w]] as Point[]).map(place);
  to.prism(body, 0.04, heights.car, colour);
  const cabin = ([[-0.45 * l, -0.55 * w], [0.3 * l, -0.5 * w], [0.3 * l, 0.5 * w], [-0.45 * l, 0.55 * w]] as Point[]).map(place);
  to.prism(cabin, heights.car, 0.22, theme.wheel, colour);
}

function obstacle(to: Solids, body: Body, size: CarSize, colour: Rgba, theme: Theme) {
  if (body.kind === 1) car(to, body, size, 0, colour, theme);
  else to.prism(body.kind === 3 ? circle(body.x, body.y, body.length / 2, 20) : corners(body), 0, body.kind === 3 ? heights.pole : heights.box, colour);
}
