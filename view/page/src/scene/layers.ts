import { get, make } from "../dom";
import { on, page, redraw } from "../page";
import { theme } from "../theme";
import { css, rampCss } from "./palette";

/** A layer that can be shown: its name, title, description and, if it has one, its colour in the theme. */
export const layers = [
  ["costMap", "Cost map", "where the rear axle would mean a collision, from the scan", "cost"],
  ["path", "Course line", "the line to follow", "path"],
  ["scan", "LiDAR", "end points of the scan", "scan"],
  ["candidates", "Candidates", "sampled control sequences, coloured by cost", undefined],
  ["guides", "Guides", "guide particles and how the solver moved them", "guide"],
  ["nominal", "Nominal", "the sequence around which samples are weighted", "nominal"],
  ["plan", "Plan", "the sequence whose beginning is driven", "plan"],
  ["spread", "Spread", "two standard deviations of the plan, from the solver's covariance", "spread"],
  ["driven", "Driven line", "the path that was driven", "driven"],
  ["obstacles", "Obstacles", "parked cars, boxes, poles and people", "obstacle"],
  ["opponents", "Opponents", "other cars; outlines and dots: where the planner expects them", "opponent"],
  ["modes", "Caption", "which way around the next obstacle the samples and the plan take", "nominal"],
  ["ghost", "Ghost", "the second controller, in a world of its own", "ghost"],
] as const;
export type Layer = (typeof layers)[number][0];

/** The layers that are chosen to be shown. */
export const visible = new Set<Layer>(layers.map(([name]) => name));
/** The term of the cost that colours the candidates, or "density". */
export let term = "total";
/** The terms of the cost; the last is the solver's cost. */
export const costTerms = () => [...(page.hello?.terms ?? []), "total"];

const rows = layers.map(([name, title, text]) => {
  const box = make("input", { type: "checkbox", checked: true });
  box.dataset.layer = name;
  box.onchange = () => show(name, box.checked);
  const swatch = make("span", { className: "swatch" });
  return { name, box, swatch, row: make("label", { title: text, hidden: true }, box, title, swatch) };
});
get("layer-list").append(...rows.map(({ row }) => row));

/** Shows a layer, or hides it. */
export function show(layer: Layer, isShown: boolean) {
  rows.find(({ name }) => name === layer)!.box.checked = isShown;
  if (isShown) visible.add(layer);
  else visible.delete(layer);
  redraw();
}

const select = get<HTMLSelectElement>("term");
select.onchange = () => {
  term = select.value;
  const isDense = term === "density";
  for (const id of ["ramp", "scale-range"]) get(id).hidden = isDense;
  const text = isDense
    ? "opaque where they are many"
    : "low to high cost; line width = weight; red: collides";
  get("scale-text").textContent = text;
  redraw();
};

on("hello", () => {
  const options = costTerms().map((name) => {
    const text = name[0].toUpperCase() + name.slice(1) + " cost";
    return new Option(text, name, name === "total", name === term);
  });
  select.replaceChildren(...options, new Option("Density", "density", false, term === "density"));
});

/** Whether the frame that is shown has data of a layer. */
export function hasData(layer: Layer): boolean {
  const { frame, scene } = page;
  if (!frame) return false;
  const has = (test: (kind: number) => boolean) => frame.bodies.some((body) => test(body.kind));
  const data: Partial<Record<Layer, unknown>> = {
    ...frame,
    path: scene?.path || frame.lines,
    driven: true,
    modes: frame.candidates && has((kind) => ![0, 4, 6].includes(kind)),
    obstacles: frame.polygons?.length || has((kind) => ![0, 4, 6].includes(kind)),
    opponents: frame.others || has((kind) => kind === 4),
    spread: frame.plan?.some((state) => state.spread > 0),
    ghost: frame.ghostFrame,
  };
  return Boolean(data[layer]);
}

// A layer without data is greyed, and hidden while the drive has had none.
on("forgotten", () => rows.forEach(({ row }) => (row.hidden = true)));
on("frame", () => {
  for (const { name, row } of rows) {
    const isEmpty = !hasData(name);
    row.classList.toggle("empty", isEmpty);
    row.hidden &&= isEmpty;
  }
});

on("theme", () => {
  get("ramp").style.background = rampCss(theme);
  for (const [i, [, , , colour]] of layers.entries()) {
    const c = colour && theme[colour];
    rows[i].swatch.style.background = c ? css([c[0], c[1], c[2], Math.max(0.45, c[3])]) : rampCss(theme);
  }
});
