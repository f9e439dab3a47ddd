import type uPlot from "uplot";
import { send } from "../connection";
import { get, make } from "../dom";
import { on, page, redraw, scalar } from "../page";
import type { Candidates, Frame } from "../protocol";
import { bodyHit, collisionPoint } from "../scene/candidates";
import { costTerms } from "../scene/layers";
import { Chart, css, fromZero, vertical } from "./plots";
import { looks } from "./strips";
import { showPane } from "./tabs";

// Says what the solver knows of a candidate that is chosen, and how costs and weights are spread.

const percent = (share: number) => `${(100 * share).toPrecision(2)} %`;
const short = (value: number) => (Number.isFinite(value) ? String(Number(value.toPrecision(4))) : "–");

/** The candidates in the order of the solver's cost, the best first. */
function ranked(c: Candidates): number[] {
  const cost = (i: number) => c.terms[c.width * (i + 1) - 2];
  return Array.from({ length: c.count }, (_, i) => i).sort((a, b) => cost(a) - cost(b));
}

/** The index of the candidate of the frame that is chosen; -1 if there is none. */
export let chosen = -1;
let choice = { index: -1, mark: "" as string | undefined }; // with its costs, to know it again
const rank = get<HTMLInputElement>("rank");
const root = get("inspect-charts");
const horizon = new Chart(root, "Cost over the horizon: plan solid, candidate dotted", []);
const costs = new Chart(root, "Candidates by cost, without collisions", []);
const weights = new Chart(root, "Candidates by weight, %", []);
const effective = new Chart(root, "Effective sample size by temperature, with the one in use", []);
let inputs: Chart[] = []; // one for each input of a step

on("hello", (hello) => {
  for (const each of inputs) each.box.remove();
  inputs = hello.inputs.map((name) => {
    const title = `Input ${name.replace("^2", "²")}: plan solid, nominal dashed, its guide at first dotted`;
    return new Chart(root, title, []);
  });
});

/** Chooses a candidate of the frame that is shown, and pauses there. */
export function choose(index: number) {
  choice = { index, mark: markOf(index) };
  chosen = index;
  if (index >= 0) showPane("inspect");
  if (index >= 0 && !page.state?.paused) send({ do: "seek", tick: scalar("tick") });
  show();
  redraw();
}
rank.onchange = () => {
  const candidates = page.frame?.candidates;
  if (candidates) choose(ranked(candidates)[Number(rank.value) - 1] ?? -1);
};

function markOf(i: number) {
  const c = page.frame?.candidates;
  return c?.terms.subarray(c.width * i, c.width * (i + 1)).join();
}
// Later frames may still come before the drive pauses at that of the choice.
on("frame", () => {
  chosen = markOf(choice.index) === choice.mark ? choice.index : -1;
  show();
});
on("shown", show);
on("theme", show);
new ResizeObserver(show).observe(root);

function show() {
  const { frame } = page;
  if (get("pane-inspect").hidden || !frame?.candidates) return;
  const c = frame.candidates;
  const order = ranked(c);
  const place = order.indexOf(chosen) + 1;
  rank.max = String(c.count);
  if (document.activeElement !== rank) rank.value = place ? String(place) : "";
  get("inspect-text").textContent = place ? sentence(frame, c, place) : hint(c);
  showTerms(frame, c);
  drawHorizon(frame);
  const free = order.filter((k) => !c.collided[k]).map((k) => c.terms[c.width * (k + 1) - 2]);
  drawHistogram(costs, free, "");
  const shares = order.map((k) => 100 * c.terms[c.width * (k + 1) - 1]);
  drawHistogram(weights, shares, "%");
  drawEffective(frame);
  drawInputs(frame);
}

function hint(c: Candidates) {
  const collided = c.collided.filter((v) => v > 0).length;
  const count = `${c.count} of ${scalar("samples")} samples are shown; ${collided} of them collide.`;
  return count + " Click one in the scene (Select), or enter its rank.";
}

function sentence(frame: Frame, c: Candidates, place: number) {
  const weight = percent(c.terms[c.width * (chosen + 1) - 1]);
  const at = collisionPoint(frame, chosen);
  const time =
    at === undefined ? "" : ` after ${(at * scalar("prediction_step")).toFixed(2)} s, at the cross`;
  const hit = at === undefined ? "" : bodyHit(frame, chosen, at);
  const end = c.collided[chosen] ? `It collides${hit && ` with ${hit}`}${time}.` : "It does not collide.";
  return `Rank ${place} of ${c.count} by cost, weight ${weight}. ${end}`;
}

function showTerms(frame: Frame, c: Candidates) {
  const names = costTerms();
  const plan = names.slice(0, -1).map((name) => scalar(`${name}_cost`, frame.scalars));
  plan.push(plan.reduce((a, b) => a + b, 0));
  const rows = names.map((name, k) => {
    const candidate = chosen < 0 ? "" : short(c.terms[c.width * chosen + k]);
    const cells = [short(plan[k]), candidate].map((text) => make("td", { className: "n" }, text));
    const mark = make("i", { className: "swatch" });
    mark.style.background = k < names.length - 1 ? `var(--${looks[k % looks.length][0]})` : "none";
    return make("tr", {}, make("td", {}, mark, name), ...cells);
  });
  get("inspect-terms").replaceChildren(...rows);
}

const timesOf = (points: number) =>
  Array.from({ length: points }, (_, p) => +(p * scalar("prediction_step")).toFixed(4));

/** Draws lines over the time of the plan. */
function drawLines(chart: Chart, lines: number[][], look: (k: number) => uPlot.Series) {
  const series = lines.map((_, k) => ({ width: 1.6, ...look(k) }));
  chart.draw("s", [timesOf(lines[0].length), ...lines], { series });
}

function drawHorizon({ stepCosts }: Frame) {
  horizon.box.hidden = !stepCosts;
  if (!stepCosts) return;
  const { terms, points, costs } = stepCosts;
  const of = (trajectory: number, term: number) =>
    Array.from({ length: points }, (_, p) => costs[(trajectory * points + p) * terms + term]);
  const all = Array.from({ length: terms }, (_, k) => k);
  const isKnown = chosen >= 0 && costs.length >= (2 + chosen) * points * terms;
  const lines = [...all.map((k) => of(0, k)), ...(isKnown ? all.map((k) => of(1 + chosen, k)) : [])];
  drawLines(horizon, lines, (k) => {
    const [colour] = looks[(k % terms) % looks.length];
    return { stroke: css(`--${colour}`), dash: k < terms ? undefined : [2, 3] };
  });
}

function drawEffective({ effectiveSamples }: Frame) {
  effective.box.hidden = !effectiveSamples;
  if (!effectiveSamples) return;
  const [x, y] = [0, 1].map((k) => Array.from(effectiveSamples).filter((_, i) => i % 2 === k));
  effective.draw("", [x.map((v) => +v.toPrecision(3)), y], {
    scales: { x: { time: false, distr: 3 }, y: { range: fromZero(4) } },
    series: [{ width: 1.6, stroke: css("--blue") }],
    hooks: { draw: [(u) => vertical(u, scalar("temperature"), "--warn", [5, 4])] },
  });
}

/** Draws the inputs of each step: those of the plan, and of the nominal sequence before and after. */
function drawInputs({ inputs: all }: Frame) {
  const colours = ["accent", "text", "violet"];
  const dashes = [undefined, [6, 3], [2, 3]];
  for (const [k, chart] of inputs.entries()) {
    chart.box.hidden = !all || k >= all.inputs;
    if (!all || k >= all.inputs) continue;
    const { steps, inputs: count, values } = all;
    const lines = Array.from({ length: values.length / (steps * count) }, (_, s) =>
      Array.from({ length: steps }, (_, p) => values[(s * steps + p) * count + k]),
    );
    drawLines(chart, lines, (s) => ({ stroke: css(`--${colours[s]}`), dash: dashes[s] }));
  }
}

function drawHistogram(chart: Chart, values: number[], unit: string) {
  const finite = values.filter(Number.isFinite).sort((a, b) => a - b);
  chart.box.hidden = finite.length < 2;
  if (finite.length < 2) return;
  chart.histogram(unit, finite, finite[0], finite[Math.floor(0.98 * (finite.length - 1))]);
}
