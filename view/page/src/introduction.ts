import { all, counted, get } from "./dom";
import { modesOf, verdict } from "./modes";
import { page, scalar, send } from "./page";
import type { Frame } from "./protocol";
import type { SceneView } from "./scene/scene";
import { toast } from "./toast";

/** Layers in the order in which they are explained, and those that are not. */
const explained = ["candidates", "plan", "guides"];
const hidden = ["spread", "nominal"];

/** One thing that the viewer is told. */
interface Step {
  /** The number of layers that are shown. */
  layers: number;
  /** Whether the drive is to stop at a frame; without it the step follows the one before. */
  due?(frames: Frame[]): boolean;
  text(frames: Frame[]): string;
}

const method = (of: Frame) => page.hello!.methods[scalar("method", of.scalars)];
const contacts = (of: Frame) => scalar("contacts", of.scalars);
const verdicts = (frames: Frame[]) => frames.map((each) => verdict(modesOf(each)));
const list = (frames: Frame[], text: (frame: Frame) => string) => frames.map(text).join(", ");
const hits = (of: Frame) =>
  contacts(of) === 0 ? "without a collision" : `with ${counted(contacts(of), "collision")}`;
const outcome = (of: Frame) => `${method(of)} ${hits(of)}`;

// docs/live-view.md says how they were driven.
const laps = "100 laps among five parked cars each";
const overLaps = "mppi hits 22 % of the cars (95 % interval: 19 to 26 %) and svg_mppi 9 % (7 to 12 %)";
/** Options that take the guides from svg_mppi: neither nominal sequence nor variances are theirs. */
const guideOptions = ["svg_mppi.use_nominal", "svg_mppi.adapt_covariance"];

const steps: Step[] = [
  {
    layers: explained.length,
    text: (both) =>
      `${both.map(method).join(" and ")} drive the same car with the same seed. ` +
      "A parked car stands in the middle of the road.",
  },
  {
    layers: 1,
    due: (both) => both.every((each) => modesOf(each)) && modesOf(both[0])!.plan !== "into",
    text: (both) =>
      "Samples: before each control step, mppi (model predictive path integral control) and svg_mppi " +
      "(Stein variational guided mppi) try many control sequences " +
      `(${list(both, (each) => `${method(each)} ${scalar("samples", each.scalars)}`)}). ` +
      "Each line shows where one of them leads.",
  },
  {
    layers: 1,
    text: () =>
      "Weights: the lower the cost of a sample, the more weight it has, and the wider and more opaque is " +
      "its line. Red samples collide.",
  },
  {
    layers: 2,
    text: () =>
      "Plan: the green line with dots is the weighted average of the samples. The car drives its beginning.",
  },
  {
    layers: 3,
    text: () =>
      "Guides: before it samples, svg_mppi improves one sequence until its cost is low: the purple line. " +
      "Its samples spread around this line only as far as the cost stays low. mppi has no guide.",
  },
  {
    layers: 3,
    due: (both) => verdicts(both).join() === "commits,averages",
    text: ([car, ghost]) =>
      `Two ways: left and right of the parked car. ${method(ghost)} gives weight to both, and the plan ` +
      `between them leads into the car. ${method(car)} chooses one.`,
  },
  {
    layers: 3,
    due: (both) => both.some(contacts),
    text: (both) =>
      `${both.filter(contacts).map(method).join(" and ")} has hit the parked car, at the cross.`,
  },
  {
    layers: 3,
    due: () => page.state!.rate === 1,
    text: (both) =>
      `Passed: ${list(both, outcome)}. This is one drive, with a seed that shows the difference. ` +
      `In ${laps}, with this configuration, ${overLaps}. ` +
      "Now drag the parked car yourself: both plan again at once.",
  },
];
const decision = 5; // step at which the two differ
const last = steps.length - 1;

/** The first thing that a new user sees: two controllers before one obstacle. The viewer ends each step. */
export class Introduction {
  private readonly box = get("introduction");
  private step = 0;
  private isWaiting = false; // for the viewer
  private hasStopped = false; // the drive, since the step was due
  private ticks: number[] = []; // at which the steps were due
  private frames: Frame[] = []; // frame of the car, and of the ghost

  /** `close` shows the ordinary view. */
  constructor(
    private readonly scene: SceneView,
    private readonly close: () => void,
  ) {
    get("introduction-next").onclick = () => this.next();
    get("introduction-drag").onclick = () => {
      send({ do: "seek", tick: this.ticks[decision] ?? this.ticks[1] });
      this.hide();
    };
    get("introduction-without").onclick = () => {
      this.hide();
      for (const key of guideOptions) send({ do: "set", key, value: "false" });
      send({ do: "restart" });
      send({ do: "rate", rate: 0.25 });
      toast(`svg_mppi without guides: ${guideOptions.join(" and ")} are off.`);
    };
    get("introduction-again").onclick = () => send({ do: "restart" });
    get("introduction-close").onclick = () => this.end();
  }

  get isOpen() {
    return !this.box.hidden;
  }
  /** Opens, with a camera that turns with the car, if motion is welcome, and sees about 7 m. */
  open() {
    const { camera } = this.scene;
    this.box.hidden = false;
    for (const name of hidden) setLayer(name, false);
    get<HTMLDetailsElement>("layers").open = false;
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) camera.follow = "heading";
    camera.zoom = Math.max(30, camera.room / 7);
  }
  end() {
    if (!this.isOpen) return;
    this.hide();
    this.close();
  }
  private hide() {
    this.box.hidden = true;
    this.scene.marks = [];
    for (const name of [...hidden, ...explained]) setLayer(name, true);
  }

  /** Takes a frame: stops the drive at a step that is due, and shows what belongs to the frame. */
  show(frame: Frame) {
    if (!this.isOpen || !frame.ghostFrame) return;
    this.frames = [frame, frame.ghostFrame];
    const tick = scalar("tick");
    while (this.step > 0 && tick < this.ticks[this.step]) this.tell(this.step - 1, false);
    // Frames that were under way come after the stop; later ones mean that the viewer has gone on.
    if (!page.state?.paused) this.isWaiting &&= !this.hasStopped;
    else if (page.state.tick === this.ticks[this.step]) this.hasStopped = true;
    const due = steps.findIndex((each, i) => i > this.step && each.due?.(this.frames));
    if (!this.isWaiting && due > 0 && get("take-over").hidden) {
      for (let i = this.step + 1; i <= due; ++i) this.ticks[i] = tick;
      send({ do: "seek", tick });
      this.hasStopped = false;
      this.tell(due, true);
    } else this.tell(this.step, this.isWaiting);
  }

  /** Goes to the next step: at once, or drives until one is due. */
  private next() {
    if (this.step < last && !steps[this.step + 1].due) {
      this.ticks[this.step + 1] = this.ticks[this.step];
      return this.tell(this.step + 1, true);
    }
    this.tell(this.step, false);
    send({ do: "play" });
  }

  private tell(step: number, isWaiting: boolean) {
    if (step !== this.step) explained.forEach((name, i) => setLayer(name, i < steps[step].layers));
    this.step = step;
    this.isWaiting = isWaiting;
    const number = step > 0 && step < last ? `${step} of ${last - 1}. ` : "";
    const text = number + steps[step].text(this.frames);
    if (get("introduction-text").textContent !== text) get("introduction-text").textContent = text;
    get("introduction-next").hidden = !isWaiting || step === last;
    for (const id of ["drag", "without", "again"]) get(`introduction-${id}`).hidden = step !== last;
    const hit = this.frames.map((each) => (contacts(each) > 0 ? each.bodies[0] : undefined));
    if (!hit.some(Boolean)) this.scene.marks = [];
    else if (!this.scene.marks.length)
      this.scene.marks = hit.flatMap((car, i) =>
        car ? [{ x: car.x, y: car.y, shown: true, isGhost: i > 0 }] : [],
      );
  }
}

function setLayer(name: string, on: boolean) {
  const box = all<HTMLInputElement>(`[data-layer="${name}"]`)[0];
  if (box.checked !== on) box.click();
}
