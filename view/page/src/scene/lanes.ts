import { counted, get } from "../dom";
import { Caption } from "../modes";
import type { Camera } from "./camera";
import { page, scalar } from "../page";
import type { Frame } from "../protocol";
import type { SceneView } from "./scene";

const margin = 12; // pixels

/** Titles and captions of the lanes, and the line between them, while the ghost is shown beside the car. */
export class Lanes {
  readonly captions = [new Caption(get("modes")), new Caption(get("ghost-modes"))];
  private readonly titles = [get("lane-title"), get("ghost-lane-title")];

  constructor(private readonly scene: SceneView) {}

  /** Shows what a frame says at a time (s). */
  show(frame: Frame, time: number) {
    const isShown = this.scene.visible.has("modes") && !page.hello!.problem;
    const both = this.scene.isSideBySide ? [frame, frame.ghostFrame!] : [frame, undefined];
    both.forEach((each, i) => {
      const method = each && page.hello!.methods[scalar("method", each.scalars)];
      const collisions = scalar("contacts", each?.scalars);
      this.captions[i].show(method ?? "", isShown ? each : undefined, time);
      if (each) this.titles[i].textContent = `${method} · ${counted(collisions, "collision")}`;
    });
  }

  /** Puts all to their places, after the cameras have been put to theirs. */
  place() {
    const { scene } = this;
    const on = scene.isSideBySide;
    const stage = get("stage");
    stage.classList.toggle("split", on);
    [scene.camera, scene.stage.ghostCamera].forEach((camera, i) => {
      const title = this.titles[i];
      const caption = get(i ? "ghost-modes" : "modes");
      title.hidden = !on;
      caption.style.cssText = on
        ? this.box(camera, stage) + `bottom:${stage.clientHeight - camera.top - camera.height + margin}px`
        : "";
      if (on) title.style.cssText = this.box(camera, stage) + `top:${camera.top + camera.covered.top - 32}px`;
    });
    const divider = get("divider");
    const c = scene.stage.ghostCamera;
    divider.hidden = !on;
    if (on)
      divider.style.cssText =
        c.top > 0 ? `top:${c.top}px;left:0;right:0;height:1px` : `left:${c.left}px;top:0;bottom:0;width:1px`;
  }

  /** The middle of what panels leave free of a lane. */
  private box(camera: Camera, stage: HTMLElement) {
    const free = camera.width - camera.covered.left - camera.covered.right;
    const width = Math.max(120, free - 2 * margin);
    return `left:${Math.min(camera.middleX, stage.clientWidth)}px;max-width:${width}px;`;
  }
}
