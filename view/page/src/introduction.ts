import { send } from "./connection";
import { click, counted, get } from "./dom";
import { modesOf, verdict } from "./modes";
import { drivenOf, isReplay, methodOf, on, page, scalar } from "./page";
import type { Frame } from "./protocol";
import { isNew } from "./scenario";
import { show, type Layer } from "./scene/layers";
import { camera, isSplit, setSplit } from "./scene/stage";
import { toast } from "./toast";

// The first thing that a new user sees: two controllers before one obstacle. The viewer ends each step.

/** Layers in the order in which they are explained, and those that are not. */
const explained: Layer[] = ["candidates", "plan", "guides"];
const hidden: Layer[] = ["spread", "nominal"];

/** One thing that the viewer is told. */
interface Caption {
  /** The number of layers that are shown. */
  layers: number;
  /** Whether the drive is to stop at a frame; without it the caption follows the one before. */
  due?(frames: Frame[]): boolean;
  text(frames: Frame[]): string;
}

const contacts = (of: Frame) => scalar("contacts", of.scalars);
const verdicts = (frames: Frame[]) => frames.map((each) => verdict(modesOf(each)));
const list = (frames: Frame[], text: (frame: Frame) => string) => frames.map(text).join(", ");
const hits = (of: Frame) =>
  contacts(of) === 0 ? "without a collision" : `with ${counted(contacts(of), "collision")}`;
const outcome = (of: Frame) => `${methodOf(of)} ${hits(of)}`;

// docs/live-view.md says how they were driven.
const laps = "100 laps among five parked cars each";
const overLaps = "mppi hits 22 % of the cars (95 % interval: 19 to 26 %) and svg_mppi 9 % (7 to 12 %)";
/** Options that take the guides from svg_mppi: neither nominal sequence nor variances are theirs. */
const guideOptions = ["svg_mppi.use_nominal", "svg_mppi.adapt_covariance"];

const captions: Caption[] = [
  {
    layers: explained.length,
    text: (both) =>
      `${both.map(methodOf).join(" and ")} drive the same car with the same seed. ` +
      "A parked car stands in the middle of the road.",
  },
  {
    layers: 1,
    due: (both) => both.every((each) => modesOf(each)) && modesOf(both[0])!.plan !== "into",
    text: (both) =>
      "Samples: before each control step, mppi (model predictive path integral control) and svg_mppi " +
      "(Stein variational guided mppi) try many control sequences " +
      `(${list(both, (each) => `${methodOf(each)} ${scalar("samples", each.scalars)}`)}). ` +
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
      `Two ways: left and right of the parked car. ${methodOf(ghost)} gives weight to both, and the plan ` +
      `between them leads into the car. ${methodOf(car)} chooses one.`,
  },
  {
    layers: 3,
    due: (both) => both.some(contacts),
    text: (both) =>
      `${both.filter(contacts).map(methodOf).join(" and ")} has hit the parked car, at the cross.`,
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
const decision = 5; // caption at which the two differ
const last = captions.length - 1;

const box = get("introduction");
let shown = 0; // caption
let isWaiting = false; // for the viewer
let hasStopped = false; // the drive, since the caption was due
const ticks: number[] = []; // at which the captions were due
let frames: Frame[] = []; // frame of the car, and of the ghost
let isFirst = isNew && !isReplay; // whether the next state is the first
/** Where a car has collided; `isGhost`: in the world of the second controller. */
export let marks: { x: number; y: number; isGhost: boolean }[] = [];

/** Opens, with a camera that turns with the car, if motion is welcome, and sees about 7 m. */
function open() {
  box.hidden = false;
  setSplit(true);
  for (const name of hidden) show(name, false);
  get<HTMLDetailsElement>("layers").open = false;
  if (!matchMedia("(prefers-reduced-motion: reduce)").matches) camera.follow = "heading";
  camera.zoom = Math.max(30, camera.room / 7);
}
function close() {
  box.hidden = true;
  marks = [];
  for (const name of [...hidden, ...explained]) show(name, true);
}
/** Shows the ordinary view. */
function end() {
  if (box.hidden) return;
  close();
  setSplit(false);
}

click("introduction-next", next);
click("introduction-drag", () => {
  send({ do: "seek", tick: ticks[decision] ?? ticks[1] });
  close();
});
click("introduction-without", () => {
  close();
  for (const key of guideOptions) send({ do: "set", key, value: "false" });
  send({ do: "restart" });
  send({ do: "rate", rate: 0.25 });
  toast(`svg_mppi without guides: ${guideOptions.join(" and ")} are off.`);
});
click("introduction-again", () => send({ do: "restart" }));
click("introduction-close", end);
click("split", () => {
  if (!box.hidden) end();
  else if (page.frame?.ghostFrame) setSplit(!isSplit);
});

on("state", ({ introduction }) => {
  if (isFirst && introduction) open();
  isFirst = false;
  if (!introduction) end();
});

// Stops the drive at a caption that is due, and shows what belongs to the frame.
on("frame", (frame) => {
  if (box.hidden || !frame.ghostFrame) return;
  frames = [frame, frame.ghostFrame];
  const tick = scalar("tick");
  while (shown > 0 && tick < ticks[shown]) tellViewer(shown - 1, false);
  // Frames that were under way come after the stop; later ones mean that the viewer has gone on.
  if (!page.state?.paused) isWaiting &&= !hasStopped;
  else if (page.state.tick === ticks[shown]) hasStopped = true;
  const due = captions.findIndex((each, i) => i > shown && each.due?.(frames));
  if (isWaiting || due <= 0 || !page.role?.drives) return tellViewer(shown, isWaiting);
  for (let i = shown + 1; i <= due; ++i) ticks[i] = tick;
  send({ do: "seek", tick });
  hasStopped = false;
  tellViewer(due, true);
});

/** Goes to the next caption: at once, or drives until one is due. */
function next() {
  if (shown < last && !captions[shown + 1].due) {
    ticks[shown + 1] = ticks[shown];
    return tellViewer(shown + 1, true);
  }
  tellViewer(shown, false);
  send({ do: "play" });
}

function tellViewer(caption: number, waits: boolean) {
  if (caption !== shown) explained.forEach((name, i) => show(name, i < captions[caption].layers));
  shown = caption;
  isWaiting = waits;
  const number = shown > 0 && shown < last ? `${shown} of ${last - 1}. ` : "";
  const text = number + captions[shown].text(frames);
  if (get("introduction-text").textContent !== text) get("introduction-text").textContent = text;
  get("introduction-next").hidden = !isWaiting || shown === last;
  for (const id of ["drag", "without", "again"]) get(`introduction-${id}`).hidden = shown !== last;
  const hit = frames.map((each) => (contacts(each) > 0 ? drivenOf(each) : undefined));
  if (!hit.some(Boolean)) marks = [];
  else if (!marks.length)
    marks = hit.flatMap((car, i) => (car ? [{ x: car.x, y: car.y, isGhost: i > 0 }] : []));
}
