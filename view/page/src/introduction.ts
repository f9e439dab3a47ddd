import { modesOf, verdict } from "./modes";
import type { Frame, Hello } from "./protocol";

const get = (id: string) => document.getElementById(id)!;

/** Layers that the introduction does not explain. */
const hidden = ["spread", "nominal"];

/** The first thing that a new user sees: two controllers before the same obstacle, and what each of them does. */
export class Introduction {
  private readonly box = get("introduction");
  private hasJudged = false; // a caption has said what a controller does
  private tick = 0;

  /** `again` drives from the start; `close` shows the ordinary view. */
  constructor(again: () => void, private readonly close: () => void) {
    get("introduction-again").onclick = again;
    get("introduction-close").onclick = () => this.end();
  }

  get isOpen() { return !this.box.hidden; }
  open() {
    this.box.hidden = false;
    this.setLayers(false);
  }
  end() {
    if (!this.isOpen) return;
    this.box.hidden = true;
    this.setLayers(true);
    this.close();
  }
  private setLayers(on: boolean) {
    for (const box of document.querySelectorAll<HTMLInputElement>("[data-layer]")) if (hidden.includes(box.dataset.layer!) && box.checked !== on) box.click();
  }

  /** Says what is to be seen in a frame. */
  show(frame: Frame, hello: Hello) {
    if (!this.isOpen || !frame.ghostFrame) return;
    const both = [frame, frame.ghostFrame], modes = both.map(modesOf);
    const scalar = (of: Frame, name: string) => of.scalars[hello.scalars.indexOf(name)], method = (of: Frame) => hello.methods[scalar(of, "method")];
    if (scalar(frame, "tick") < this.tick) this.hasJudged = false;
    this.tick = scalar(frame, "tick");
    const isPassing = modes.some(Boolean), collisions = (of: Frame) => { const n = scalar(of, "contacts"); return n === 0 ? "without a collision" : n === 1 ? "with 1 collision" : `with ${n} collisions`; };
    this.hasJudged ||= modes.some((each) => verdict(each) !== undefined);
    const text = isPassing
      ? "Slow motion. Lines are samples: the wider and the more opaque, the more weight. The line with dots is the plan."
      : this.hasJudged
        ? `Passed: ${both.map((of) => `${method(of)} ${collisions(of)}`).join(", ")}. Now both drive on.`
        : `${both.map(method).join(" and ")} drive the same car with the same seed. A parked car stands in the middle of the road.`;
    if (get("introduction-text").textContent !== text) get("introduction-text").textContent = text;
  }
}
