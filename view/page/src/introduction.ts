import { all, counted, get } from "./dom";
import { modesOf, verdict } from "./modes";
import { page, scalar, send } from "./page";
import type { Frame } from "./protocol";
import type { Camera } from "./scene/camera";

/** Layers that the introduction does not explain. */
const hidden = ["spread", "nominal"];

/** The first thing that a new user sees: two controllers before the same obstacle. */
export class Introduction {
  private readonly box = get("introduction");
  private hasJudged = false; // a caption has said what a controller does
  private tick = 0;

  /** `close` shows the ordinary view. */
  constructor(private readonly close: () => void) {
    get("introduction-again").onclick = () => send({ do: "restart" });
    get("introduction-close").onclick = () => this.end();
  }

  get isOpen() {
    return !this.box.hidden;
  }
  /** Opens, with a camera that turns with the car, if motion is welcome, and sees about 7 m. */
  open(camera: Camera) {
    this.box.hidden = false;
    this.setLayers(false);
    get<HTMLDetailsElement>("layers").open = false;
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) camera.follow = "heading";
    camera.zoom = Math.max(30, camera.room / 7);
  }
  end() {
    if (!this.isOpen) return;
    this.box.hidden = true;
    this.setLayers(true);
    this.close();
  }
  private setLayers(on: boolean) {
    for (const box of all<HTMLInputElement>("[data-layer]"))
      if (hidden.includes(box.dataset.layer!) && box.checked !== on) box.click();
  }

  /** Says what is to be seen in a frame. */
  show(frame: Frame) {
    if (!this.isOpen || !frame.ghostFrame) return;
    const both = [frame, frame.ghostFrame];
    const modes = both.map(modesOf);
    const method = (of: Frame) => page.hello!.methods[scalar("method", of.scalars)];
    if (scalar("tick") < this.tick) this.hasJudged = false;
    this.tick = scalar("tick");
    this.hasJudged ||= modes.some((each) => verdict(each) !== undefined);
    const outcome = (of: Frame) => `${method(of)} ${collisions(scalar("contacts", of.scalars))}`;
    const passing =
      "Lines are samples: the wider and the more opaque, the more weight. The line with dots is the plan.";
    const drivers = both.map(method).join(" and ");
    const text = modes.some(Boolean)
      ? `Slow motion. ${passing}`
      : this.hasJudged
        ? `Passed: ${both.map(outcome).join(", ")}. Now both drive on.`
        : `${drivers} drive the same car with the same seed. A parked car stands in the middle of the road.`;
    if (get("introduction-text").textContent !== text) get("introduction-text").textContent = text;
  }
}

function collisions(n: number): string {
  return n === 0 ? "without a collision" : `with ${counted(n, "collision")}`;
}
