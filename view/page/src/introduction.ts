import { send } from "./connection";
import { click, get, make } from "./dom";
import { isIntroduction, on, scalar } from "./page";
import { show, type Layer } from "./scene/layers";
import { setSplit } from "./scene/stage";

// The first thing that a new user sees: a recording of two controllers before one obstacle, with a text for five of
// its steps. What is shown depends on the step alone, so every control may be used.

/** The step of the recording from which on something is told, the layers shown with it, and the text. */
const parts: [from: number, layers: Layer[], text: string][] = [
  [
    0,
    ["candidates"],
    "Two methods drive the same car towards a parked car. Each line is a {candidates:sample}: where one sequence of " +
      "commands would lead. The lower its cost, the wider it is; {collided:red} ones collide.",
  ],
  [
    3,
    ["candidates", "plan"],
    "The {plan:plan} is the mean of the samples, weighted by their costs. The car drives its beginning, then all is " +
      "computed anew.",
  ],
  [
    6,
    ["candidates", "plan", "guides"],
    "svg_mppi first improves a {guide:guide}, step by step, until its cost is low. Its samples lie around the guide. " +
      "mppi has none.",
  ],
  [
    10,
    ["candidates", "plan", "guides", "modes"],
    "Two ways lead around the parked car. mppi has weight on both, and the plan between them leads into the car. " +
      "svg_mppi chooses one.",
  ],
  [
    22,
    ["candidates", "plan", "guides", "modes"],
    "mppi hits the car, at the cross; svg_mppi passes. This is one drive, which shows the difference. In 100 laps " +
      "among five parked cars each, mppi hits 22\u00a0% of them (95\u00a0% interval: 19 to 26\u00a0%) and svg_mppi 9\u00a0% (7 to 12\u00a0%).",
  ],
];
const explained = new Set(parts.flatMap(([, layers]) => layers));
const part = () => parts.findLastIndex(([from]) => from <= (scalar("tick") || 0));

/** Goes to the next part, and from the last one to the first. */
export const next = () => {
  if (isIntroduction) send({ do: "seek", tick: parts[(part() + 1) % parts.length][0] });
};
click("introduction-next", next);

let shown = -1;
on("frame", ({ ghostFrame }) => {
  if (!isIntroduction || !ghostFrame || part() === shown) return;
  shown = part();
  const [, layers, text] = parts[shown];
  for (const layer of explained) show(layer, layers.includes(layer));
  const words = text.split(/\{(\w+):(\w+)\}/).map((word, i, all) => {
    if (i % 3 === 1) return "";
    const key = make("b", { className: "key" }, word);
    key.style.setProperty("--key", `var(--scene-${all[i - 1]})`);
    return i % 3 === 2 ? key : word;
  });
  get("introduction-text").replaceChildren(`${shown + 1} of ${parts.length}. `, ...words);
  const isLast = shown === parts.length - 1;
  get("introduction-next").textContent = isLast ? "Show again" : "Next";
  for (const id of ["drive", "without"]) get(`introduction-${id}`).hidden = !isLast || isFile;
});

const isFile = location.protocol === "file:";
/** The live view of the recorded drive, with its arguments in the address. */
const recorded = "#course=stag&config=published&obstacles=1&seed=77&against=mppi";
const withoutGuides = "&set=svg_mppi.use_nominal=false&set=svg_mppi.adapt_covariance=false";
const places = { drive: recorded, without: recorded + withoutGuides, close: "" };
for (const [id, place] of Object.entries(places))
  get<HTMLAnchorElement>(`introduction-${id}`).href = "./" + location.search + place;
get("introduction-close").hidden = isFile;
get<HTMLAnchorElement>("introduction-open").href = "introduction" + location.search;

get("introduction").hidden = !isIntroduction;
document.body.classList.toggle("introduction", isIntroduction);
if (isIntroduction) {
  setSplit(true);
  for (const layer of ["spread", "nominal"] as const) show(layer, false);
}
