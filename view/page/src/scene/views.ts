import type { Introduction } from "../introduction";
import { isCut, Minimap } from "./minimap";
import type { Theme } from "./palette";
import type { SceneView } from "./scene";
import { toast } from "../toast";

const get = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;

export function press(button: HTMLElement, on: boolean) {
  button.classList.toggle("on", on);
  button.setAttribute("aria-pressed", String(on));
}

/** How the scene is seen: from above or in space, with the ghost beside the car or in one picture, and its minimap. */
export class Views {
  readonly minimap = new Minimap();
  private readonly fromAbove = get("scene").getAttribute("aria-label")!;
  private readonly calm = matchMedia("(prefers-reduced-motion: reduce)");

  /** `changed`: the scene is to be laid out and drawn again. */
  constructor(private readonly scene: SceneView, private readonly introduction: Introduction, private readonly changed: () => void) {
    get("space").onclick = () => this.setInSpace(!scene.isInSpace);
    get("split").onclick = () => { if (introduction.isOpen) introduction.end(); else if (scene.frame?.ghostFrame) this.setSplit(!scene.isSplit); };
    press(get("space"), false);
    press(get("split"), false);
    get("no-picture").hidden = scene.canDraw;
    if (!scene.canDraw) this.refuseSpace("This browser has no WebGL 2.");
  }

  /** Opens on what the methods differ in. */
  introduce() {
    get<HTMLDetailsElement>("layers").open = false;
    this.introduction.open();
    this.turnWithCar();
    this.setSplit(true);
    this.scene.camera.zoom = Math.max(30, this.scene.camera.room / 7); // so that about 7 m are seen
  }

  /** Shows car and ghost side by side, or in one picture. */
  setSplit(on: boolean) {
    if (on && this.scene.isInSpace) this.setInSpace(false);
    this.scene.setSplit(on);
    press(get("split"), on);
    this.changed();
  }

  /** Shows the scene in space, or from above. */
  private setInSpace(on: boolean) {
    this.introduction.end();
    if (on && this.scene.isSplit) this.setSplit(false);
    try {
      this.scene.setInSpace(on);
    } catch (error) {
      this.refuseSpace((error as Error).message);
      return toast(get("space").title, true);
    }
    if (on && this.scene.camera.follow === "follow") this.turnWithCar();
    press(get("space"), on);
    get("stage").classList.toggle("in-space", on);
    get("scene").setAttribute("aria-label", on ? "The course, the car and the plans of the controller in space" : this.fromAbove);
    this.changed();
  }
  private refuseSpace(why: string) {
    Object.assign(get<HTMLButtonElement>("space"), { disabled: true, title: `The scene cannot be shown in space: ${why}` });
  }

  /** A view that turns all the time is not for everybody. */
  private turnWithCar() { if (!this.calm.matches) this.scene.camera.follow = "heading"; }

  /** The whole course, while only a part of it is in view. */
  showMinimap(theme: Theme) {
    const { scene } = this, map = get("minimap"), figures = get("readout");
    map.hidden = scene.isSideBySide || !scene.visible.has("minimap") || !scene.hello || (scene.isInSpace ? scene.isFitted : !isCut(scene.courseBounds, scene.camera));
    if (map.hidden) return;
    map.style.top = `${figures.offsetTop + figures.offsetHeight + 8}px`;
    this.minimap.draw(scene.courseBounds, scene.frame, theme, scene.isInSpace ? undefined : scene.camera);
  }
}
