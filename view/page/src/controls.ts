import { all, get, press } from "./dom";
import { redraw } from "./page";
import type { Layer, Term } from "./scene/layers";
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
      scene.term = term.value as Term;
      redraw();
    };
  }

  setTool(tool: Tool) {
    this.tool = tool;
    for (const b of all("[data-tool]")) press(b, b.dataset.tool === tool);
  }

  setFollow(what: "follow" | "heading" | "fit") {
    if (what === "fit") this.scene.fit();
    else this.scene.camera.follow = what;
    redraw();
  }

  /** Shows what the camera follows: a drag may have changed it. */
  showFollow() {
    const now = this.scene.isFitted ? "fit" : this.scene.camera.follow;
    for (const b of all("[data-follow]")) press(b, b.dataset.follow === now);
  }

  /** The keys that concern the view. */
  get keys(): Record<string, () => void> {
    const { scene } = this;
    const move = (x: number, y: number) => () => {
      scene.camera.pan(x * stride, y * stride);
      redraw();
    };
    const zoom = (factor: number) => () => {
      scene.zoom(factor);
      redraw();
    };
    return {
      f: () => this.setFollow(scene.camera.follow === "follow" ? "heading" : "follow"),
      a: () => this.setFollow("fit"),
      "1": () => this.setTool("disc"),
      "2": () => this.setTool("box"),
      "3": () => this.setTool("car"),
      "4": () => this.setTool("pan"),
      "+": zoom(1.2),
      "-": zoom(1 / 1.2),
      ArrowLeft: move(1, 0),
      ArrowRight: move(-1, 0),
      ArrowUp: move(0, 1),
      ArrowDown: move(0, -1),
      l: () => get<HTMLDetailsElement>("layers").toggleAttribute("open"),
    };
  }
}
