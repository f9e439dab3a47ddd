import type { Camera } from "./camera";
import type { Rgba, Theme } from "./palette";
import type { Frame, Scene } from "../protocol";

const css = (c: Rgba) => `rgb(${c.slice(0, 3).map((v) => Math.round(255 * v)).join(" ")} / ${c[3]})`;

/** The whole course in a corner, with the cars and the part that is in view. */
export class Minimap {
  private readonly canvas = document.getElementById("minimap") as HTMLCanvasElement;
  private readonly to = this.canvas.getContext("2d")!;
  private course?: HTMLCanvasElement; // of the size of the canvas
  private courseOf = "";
  private revision = 0;
  private scene: Scene = {};

  setScene(scene: Scene) {
    this.scene = { ...this.scene, ...scene };
    ++this.revision;
  }

  /** `camera`: what is in view, if it is seen from above. */
  draw(bounds: [number, number, number, number], frame: Frame | undefined, theme: Theme, camera: Camera | undefined) {
    const { to, canvas } = this, [x0, y0, x1, y1] = bounds, largest = innerWidth < 900 ? 84 : 150;
    const zoom = largest / Math.max(x1 - x0, y1 - y0), ratio = Math.min(2, devicePixelRatio || 1);
    const width = Math.round((x1 - x0) * zoom), height = Math.round((y1 - y0) * zoom);
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      Object.assign(canvas, { width: Math.round(width * ratio), height: Math.round(height * ratio) });
      canvas.style.width = width + "px";
      canvas.style.height = height + "px";
    }
    const scale = ratio * zoom, fromMap = new DOMMatrix([scale, 0, 0, -scale, -scale * x0, scale * y1]); // from m of the map frame
    to.resetTransform();
    to.clearRect(0, 0, canvas.width, canvas.height);
    const course = this.drawnCourse(theme, fromMap);
    if (course) to.drawImage(course, 0, 0);
    to.setTransform(fromMap);
    const line = (points: [number, number][], colour: string, thick: number) => {
      to.beginPath();
      points.forEach(([x, y], i) => (i ? to.lineTo(x, y) : to.moveTo(x, y)));
      to.closePath();
      to.lineWidth = thick / zoom;
      to.strokeStyle = colour;
      to.stroke();
    };
    const dot = (x: number, y: number, colour: Rgba, size: number) => {
      to.beginPath();
      to.arc(x, y, size / zoom, 0, 2 * Math.PI);
      to.fillStyle = css(colour);
      to.fill();
    };
    for (const body of frame?.bodies ?? []) if (body.kind !== 0) dot(body.x, body.y, body.kind === 4 ? theme.opponent : theme.obstacle, 2);
    if (frame?.ghost) dot(frame.ghost.x, frame.ghost.y, theme.ghost, 3);
    const car = frame?.bodies.find((body) => body.kind === 0);
    if (camera) {
      const { left, top } = camera, right = left + camera.width, bottom = top + camera.height;
      line(([[left, top], [right, top], [right, bottom], [left, bottom]] as const).map(([px, py]) => camera.toMap(px, py)), css(theme.path), 1);
    }
    if (car) { dot(car.x, car.y, theme.ground, 5); dot(car.x, car.y, theme.plan, 3.5); }
  }

  /** The free cells of the map as they appear in the minimap; drawn once, since a large map takes long to shrink. */
  private drawnCourse(theme: Theme, fromMap: DOMMatrix): HTMLCanvasElement | undefined {
    const grid = this.scene.grid;
    if (!grid) return undefined;
    const { width, height } = this.canvas, key = `${this.revision} ${theme.dark} ${width} ${height}`;
    if (this.courseOf === key) return this.course;
    const cells = Object.assign(document.createElement("canvas"), { width: grid.width, height: grid.height });
    const to = cells.getContext("2d")!, image = to.createImageData(grid.width, grid.height), free = theme.dark ? [74, 88, 106, 255] : [176, 187, 200, 255];
    for (let i = 0; i < grid.cells.length; ++i) if (grid.cells[i] === 0) image.data.set(free, 4 * i);
    to.putImageData(image, 0, 0);
    this.course = Object.assign(document.createElement("canvas"), { width, height });
    const shrunk = this.course.getContext("2d")!;
    shrunk.setTransform(fromMap);
    shrunk.translate(grid.x, grid.y);
    shrunk.rotate(grid.yaw);
    shrunk.drawImage(cells, 0, 0, grid.width * grid.resolution, grid.height * grid.resolution);
    this.courseOf = key;
    return this.course;
  }
}

/** Whether a part of the course is out of view. */
export function isCut(bounds: [number, number, number, number], camera: Camera): boolean {
  const [x0, y0, x1, y1] = bounds;
  return ([[x0, y0], [x1, y0], [x1, y1], [x0, y1]] as const).some(([x, y]) => {
    const [px, py] = camera.toScreen(x, y);
    return px < camera.left - 2 || py < camera.top - 2 || px > camera.left + camera.width + 2 || py > camera.top + camera.height + 2;
  });
}
