import { all, get, press } from "./dom";
import { page, redraw } from "./page";
import type { Frame } from "./protocol";
import type { Layer } from "./scene/layers";
import type { Tool } from "./scene/pointer";
import type { SceneView } from "./scene/scene";

const stride = 40; // pixels that an arrow key moves the view

/** The controls of the view: the tool of a click, what the camera follows, layers, and keys. */
export class Controls {
  tool: Tool = "disc";

  constructor(private readonly scene: SceneView) {
    for (const b of all("[data-tool]")) b.onclick = () => this.setTool(b.dataset.tool as Tool);
    for (const b of all("[data-follow]")) b.onclick = () => this.setFollow(b.dataset.follow as "follow");
    for (const box of all<HTMLInputElement>("[data-layer]"))
      box.onchange = () => {
        const name = box.dataset.layer as Layer;
        if (box.checked) scene.visible.add(name);
        else scene.visible.delete(name);
        redraw();
      };
    const term = get<HTMLSelectElement>("term");
    term.onchange = () => {
      scene.term = term.value;
      const isDense = term.value === "density";
      for (const id of ["ramp", "scale-range"]) get(id).hidden = isDense;
      get("scale-text").textContent = isDense
        ? "opaque where they are many"
        : "low to high cost; line width = weight";
      redraw();
    };
  }

  /** Greys the layers for which a frame has no data. */
  showData(frame: Frame) {
    const bodies = frame.bodies.map((body) => body.kind);
    const data: Partial<Record<Layer, unknown>> = {
      ...frame,
      path: this.scene.hasPath || frame.lines,
      driven: true,
      modes: !page.hello?.problem,
      obstacles: frame.polygons?.length || bodies.some((kind) => kind > 0 && kind !== 4),
      opponents: bodies.includes(4) || frame.others,
      spread: frame.plan?.some((p) => p.spread > 0),
    };
    for (const box of all<HTMLInputElement>("[data-layer]"))
      box.parentElement!.classList.toggle("empty", !data[box.dataset.layer as Layer]);
  }

  setTool(tool: Tool) {
    this.tool = tool;
    for (const b of all("[data-tool]")) press(b, b.dataset.tool === tool);
  }

  setFollow(what: "follow" | "heading" | "fit") {
    const { camera, isFitted } = this.scene;
    if (isFitted && !page.hello?.problem) camera.zoom = camera.drivingZoom;
    if (what === "fit") this.scene.fit();
    else camera.follow = what;
    redraw();
  }

  /** Shows what the camera follows: a drag may have changed it. */
  showFollow() {
    const now = this.scene.isFitted ? "fit" : this.scene.camera.follow;
    for (const b of all("[data-follow]")) press(b, b.dataset.follow === now);
  }

  follow() {
    this.setFollow(this.scene.camera.follow === "follow" ? "heading" : "follow");
  }
  move(x: number, y: number) {
    this.scene.camera.pan(x * stride, y * stride);
    redraw();
  }
  zoom(factor: number) {
    this.scene.zoom(factor);
    redraw();
  }
}
