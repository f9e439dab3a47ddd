import { send } from "./connection";
import { all, click, get } from "./dom";
import { isIntroduction, on, scalar } from "./page";
import { show, type Layer } from "./scene/layers";
import { setSplit } from "./scene/stage";

// The first thing that a new user sees: a recording of two controllers before one obstacle, with a text for five of
// its steps. What is shown depends on the step alone, so every control may be used.

/** The texts, with the steps of the recording from which on they are shown, and the layers shown with them. */
const parts = [...all<HTMLTemplateElement>("#introduction template")];
const layersOf = (part: HTMLElement) => part.dataset.layers!.split(" ") as Layer[];
const explained = new Set(parts.flatMap(layersOf));
const part = () => parts.findLastIndex(({ dataset }) => Number(dataset.from) <= (scalar("tick") || 0));

/** Goes to the next part, and from the last one to the first. */
export const next = () => {
  if (isIntroduction) send({ do: "seek", tick: Number(parts[(part() + 1) % parts.length].dataset.from) });
};
click("introduction-next", next);

let shown = -1;
on("frame", () => {
  if (!isIntroduction || part() === shown) return;
  shown = part();
  for (const layer of explained) show(layer, layersOf(parts[shown]).includes(layer));
  get("introduction-text").replaceChildren(parts[shown].content.cloneNode(true));
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
get<HTMLAnchorElement>("introduction-open").href = `introduction${location.search}`;

get("introduction").hidden = !isIntroduction;
document.body.classList.toggle("introduction", isIntroduction);
if (isIntroduction) {
  setSplit(true);
  for (const layer of ["spread", "nominal"] as const) show(layer, false);
}
