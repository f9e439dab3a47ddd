import { page, scalar } from "../page";
import type { Body, Frame, Grid, Pose, Scene } from "../protocol";
import type { Camera } from "./camera";
import { candidateAt, drawCandidates, drawChosen } from "./candidates";
import * as draw from "./drawings";
import { layers, type Layer } from "./layers";
import { painterOf, type Painter } from "./painter";
import type { Rgba, Theme } from "./palette";
import * as shapes from "./shapes";
import { Stage } from "./stage";

/** The place of a collision of an evaluation. */
export interface Mark {
  x: number;
  y: number;
  shown: boolean;
  isGhost?: boolean; // in the world of the second controller
}
const opponent = 4; // kind of body

/** Draws what the controller considers. */
export class SceneView {
  readonly visible = new Set<Layer>(layers.map(([name]) => name));
  readonly stage = new Stage();
  readonly camera = this.stage.camera;
  term = "total"; // colours the candidates
  theme: Theme;
  selected = -1; // body
  isHeld = false; // whether a pointer is pressed on the scene, which must not move under it
  chosen = -1; // candidate
  costRange: [number, number] = [0, 1]; // costs of the candidates' first and last colour
  /** Whether the ghost is to be shown beside the car, in a lane of its own. */
  isSplit = false;
  /** x and y (m) of the paths that car and ghost have driven, one after the other. */
  driven: number[] = [];
  ghostDriven: number[] = [];
  /** The pose of the best lap as long after its start as the car is after its own. */
  best?: Pose;
  /** The pose of the car at the time under the pointer. */
  probe?: Pose;
  preview?: { x: number; y: number; kind: number }; // place of the body that a click adds
  marks: Mark[] = [];
  private scene: Scene = {};
  private map?: { grid: Grid; theme: Theme; image: HTMLCanvasElement };
  bounds: [number, number, number, number] = [-5, -5, 5, 5]; // m, of course line and walls
  private fitted = "";

  constructor(
    private readonly canvas: HTMLCanvasElement,
    theme: Theme,
  ) {
    this.theme = theme;
  }

  get isSideBySide() {
    return this.isSplit && page.frame?.ghostFrame !== undefined;
  }

  get hasPath() {
    return this.scene.path !== undefined;
  }

  setScene(scene: Scene) {
    this.scene = scene;
    if (!scene.path) return;
    const room = 1.5; // m
    const axes = [0, 1].map((k) => scene.path!.xyv.filter((_, i) => i % 3 === k));
    const [x0, y0] = axes.map((all) => Math.min(...all) - room);
    const [x1, y1] = axes.map((all) => Math.max(...all) + room);
    this.bounds = [x0, y0, x1, y1];
  }

  /** Sets what `fit` shows, with some room around it. */
  setBounds([x0, y0, x1, y1]: [number, number, number, number]) {
    const room = 0.12 * Math.max(x1 - x0, y1 - y0, 0.1);
    const { isFitted } = this;
    this.bounds = [x0 - room, y0 - room, x1 + room, y1 + room];
    if (isFitted && !this.isHeld) this.fit();
  }

  /** Shows the whole course. */
  fit() {
    this.camera.fit(...this.bounds);
    this.fitted = this.place();
  }
  /** Whether the camera is where `fit` put it. */
  get isFitted() {
    return this.fitted === this.place();
  }
  private place() {
    const c = this.camera;
    return c.follow === "free" ? [c.x, c.y, c.zoom].join() : "not fitted";
  }

  /** Sets the size of the stage and what panels cover of it (pixels). A fitted course stays fitted. */
  setStage(width: number, height: number, covered: Camera["covered"]) {
    this.stage.resize(width, height, covered);
    this.layOut();
  }
  setSplit(on: boolean) {
    this.isSplit = on;
    this.layOut();
  }
  private layOut() {
    const { isFitted } = this;
    if (this.isSideBySide) this.stage.splitLanes();
    else this.stage.joinLanes();
    if (isFitted && !this.isHeld) this.fit();
  }

  zoom(factor: number) {
    this.camera.zoomAt(this.camera.middleX, this.camera.middleY, factor);
  }

  /** The body under a point of the map frame; the driven car is 0. */
  bodyAt(x: number, y: number): Body | undefined {
    const slack = 8 / this.camera.zoom;
    return page.frame?.bodies.findLast((b) => {
      const [c, s, dx, dy] = [Math.cos(b.yaw), Math.sin(b.yaw), x - b.x, y - b.y];
      const isWithin = (d: number, size: number) => Math.abs(d) <= size / 2 + slack;
      return isWithin(c * dx + s * dy, b.length) && isWithin(c * dy - s * dx, b.width);
    });
  }

  /** The candidate under a point of the map frame; -1 if there is none. */
  candidateAt(x: number, y: number) {
    const isShown = page.frame && this.visible.has("candidates");
    return isShown ? candidateAt(page.frame!, x, y, 8 / this.camera.zoom) : -1;
  }

  /** The mark under a point of the map frame. */
  markAt<M extends Mark>(marks: M[], x: number, y: number): M | undefined {
    const distance = (m: M) => Math.hypot(m.x - x, m.y - y);
    const within = marks.filter((m) => distance(m) < 10 / this.camera.zoom);
    return within.sort((a, b) => distance(a) - distance(b))[0];
  }

  /** The size of the scene, CSS pixels. */
  get size() {
    return [this.canvas.clientWidth, this.canvas.clientHeight];
  }

  /** Draws on the page, or with the pen of a picture. */
  draw(painter = painterOf(this.canvas)) {
    this.painter = painter;
    const [width, height] = this.size;
    const isEmpty = page.hello?.problem && !this.scene.grid;
    painter.begin(width, height, isEmpty ? this.theme.free : this.theme.ground);
    if (this.isSideBySide) this.stage.splitLanes();
    else this.stage.joinLanes();
    this.drawLane(this.camera, page.frame, this.driven);
    if (this.isSideBySide) this.drawLane(this.stage.ghostCamera, page.frame?.ghostFrame, this.ghostDriven);
    painter.end();
  }
  private painter!: Painter; // draws at present

  private drawLane(camera: Camera, frame: Frame | undefined, driven: number[]) {
    const { painter, theme, visible } = this;
    const car = frame?.bodies.find((b) => b.kind === 0);
    const end = frame?.plan?.at(-1);
    if (car) camera.track(car.x, car.y, car.yaw, end ? Math.hypot(end.x - car.x, end.y - car.y) : 0);
    painter.look(camera);
    if (this.scene.grid) this.drawMap(this.scene.grid);
    if (!frame) return;
    if (visible.has("costMap") && frame.costMap) draw.drawCostMap(painter, theme, frame.costMap);
    if (visible.has("path") && this.scene.path) draw.drawPath(painter, theme, this.scene.path);
    for (const xy of (visible.has("path") && frame.lines) || [])
      painter.dashed(xy, xy.length / 2, theme.path, 1.3);
    if (visible.has("driven")) painter.polyline(driven, 0, driven.length / 2, theme.driven, 2);
    if (visible.has("candidates") && frame.candidates) {
      const range = frame === page.frame ? undefined : this.costRange; // both lanes have one scale
      this.costRange = drawCandidates(painter, theme, frame.candidates, this.term, range);
    }
    if (visible.has("spread") && frame.plan) draw.drawSpread(painter, theme, frame.plan);
    if (visible.has("guides") && frame.guides) draw.drawGuides(painter, theme, frame.guides);
    if (visible.has("scan") && frame.scan && page.hello?.lidar)
      draw.drawScan(painter, theme, frame.scan, page.hello.lidar);
    this.drawBodies(frame);
    if (this.preview) this.drawPreview(this.preview);
    if (this.chosen >= 0 && frame === page.frame && frame.candidates)
      drawChosen(painter, theme, frame, this.chosen, 7 / camera.zoom);
    if (visible.has("nominal") && frame.nominal)
      painter.dashed(frame.nominal.xy, frame.nominal.points, theme.nominal, 1.6);
    if (visible.has("plan") && frame.plan) draw.drawPlan(painter, theme, frame.plan);
    if (visible.has("ghost") && !this.isSideBySide) this.drawGhost(frame);
    if (this.best && visible.has("ghost") && frame === page.frame) this.drawOutline(this.best, theme.driven);
    if (this.probe) this.drawOutline(this.probe, theme.selected);
    if (frame.figure && car) shapes.drawFigure(painter, theme, car, frame.figure);
    else if (car) {
      const steer = scalar("steer", frame.scalars) || 0;
      shapes.drawCar(painter, theme, car, steer, theme.car, car.touched ? theme.collided : theme.carEdge);
    }
    this.drawMarks(frame !== page.frame);
  }

  /** Draws the map with an image that is made once for each course and theme. */
  private drawMap(grid: Grid) {
    const { painter, theme } = this;
    if (this.map?.grid !== grid || this.map.theme !== theme)
      this.map = { grid, theme, image: draw.mapImage(theme, grid) };
    painter.image(this.map.image, grid, grid.width * grid.resolution, grid.height * grid.resolution);
  }

  private drawBodies(frame: Frame) {
    const { painter, theme, visible } = this;
    for (const body of frame.bodies) {
      if (body.kind === opponent && visible.has("opponents"))
        shapes.drawCar(painter, theme, body, 0, theme.opponent, theme.carEdge);
      else if (body.kind !== 0 && body.kind !== opponent && visible.has("obstacles"))
        shapes.drawObstacle(painter, theme, body, this.selected === body.id);
    }
    for (const polygon of frame.polygons ?? [])
      if (visible.has("obstacles")) shapes.drawPolygon(painter, theme, polygon);
    if (visible.has("opponents")) shapes.drawTracked(painter, theme, frame.others ?? []);
  }

  private drawGhost({ ghost }: Frame) {
    if (!ghost) return;
    const { painter, theme } = this;
    painter.dashed(ghost.plan, ghost.plan.length / 2, shapes.faded(theme.ghost, 0.9), 2.4);
    shapes.drawCar(painter, theme, ghost, ghost.steer, shapes.faded(theme.ghost, 0.75), theme.carEdge);
  }

  private drawPreview({ x, y, kind }: { x: number; y: number; kind: number }) {
    const size = kind === 1 ? { length: 0.58, width: 0.31 } : { length: 0.4, width: 0.4 };
    const points = kind === 3 ? shapes.circle(x, y, 0.15) : shapes.corners({ x, y, yaw: 0, ...size });
    this.painter.outline(points, this.theme.obstacle, 1.5);
  }

  private drawOutline(at: Pose, colour: Rgba) {
    this.painter.outline(shapes.corners({ ...shapes.carSize(), ...at }), colour, 2);
    this.painter.dot(at.x, at.y, 5, colour);
  }

  private drawMarks(isGhost: boolean) {
    for (const m of this.marks.filter((each) => Boolean(each.isGhost) === isGhost)) {
      const r = (m.shown ? 12 : 5) / this.camera.zoom;
      const lines = m.shown ? [7, 4] : [2.2]; // with a rim
      for (const width of lines)
        for (const up of [r, -r]) {
          const colour = width === 7 ? this.theme.free : this.theme.mark;
          this.painter.segment(m.x - r, m.y - up, m.x + r, m.y + up, colour, width);
        }
    }
  }
}
