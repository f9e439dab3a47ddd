import uPlot from "uplot";
import { get, make } from "../dom";
import { page, redraw, scalar, send } from "../page";
import type { Candidates, Frame } from "../protocol";
import { costTerms } from "../scene/layers";
import { bodyHit, collisionPoint } from "../scene/candidates";
import { Chart, css, padded, vertical } from "./plots";
import { looks } from "./strips";

const bins = 24; // number in a histogram

const percent = (share: number) => `${(100 * share).toPrecision(2)} %`;
const short = (value: number) => (Number.isFinite(value) ? String(Number(value.toPrecision(4))) : "–");

/** The candidates in the order of the solver's cost, the best first. */
function ranked(c: Candidates): number[] {
  const cost = (i: number) => c.terms[c.width * (i + 1) - 2];
  return Array.from({ length: c.count }, (_, i) => i).sort((a, b) => cost(a) - cost(b));
}

/** Says what the solver knows of a candidate that is chosen, and how costs and weights are spread. */
export class InspectPane {
  chosen = -1; // index of a candidate of the frame
  private choice = { index: -1, mark: "" as string | undefined }; // with its costs, to know it again
  private readonly rank = get<HTMLInputElement>("rank");
  private readonly horizon: Chart;
  private readonly inputs: Chart[] = []; // one for each input of a step
  private readonly costs: Chart;
  private readonly weights: Chart;
  private readonly effective: Chart;

  constructor() {
    const root = get("inspect-charts");
    this.horizon = new Chart(root, "Cost over the horizon: plan solid, candidate dotted", []);
    this.costs = new Chart(root, "Candidates by cost, without collisions", []);
    this.weights = new Chart(root, "Candidates by weight, %", []);
    this.effective = new Chart(root, "Effective sample size by temperature, with the one in use", []);
    this.rank.onchange = () => {
      const candidates = page.frame?.candidates;
      if (candidates) this.choose(ranked(candidates)[Number(this.rank.value) - 1] ?? -1);
    };
    new ResizeObserver(() => this.show()).observe(root);
  }

  /** Chooses a candidate of the frame that is shown, and pauses there. */
  choose(index: number) {
    this.choice = { index, mark: this.markOf(index) };
    this.chosen = index;
    if (index >= 0 && !page.state?.paused) send({ do: "seek", tick: page.position });
    this.show();
    redraw();
  }

  /** Shows another frame. Later ones may still come before the drive pauses at that of the choice. */
  update() {
    const { index, mark } = this.choice;
    this.chosen = this.markOf(index) === mark ? index : -1;
    this.show();
  }

  private markOf(i: number) {
    const c = page.frame?.candidates;
    return c?.terms.subarray(c.width * i, c.width * (i + 1)).join();
  }

  show() {
    const { frame } = page;
    if (get("pane-inspect").hidden || !frame?.candidates) return;
    const c = frame.candidates;
    const i = this.chosen;
    const order = ranked(c);
    this.rank.max = String(c.count);
    if (document.activeElement !== this.rank) this.rank.value = i < 0 ? "" : String(order.indexOf(i) + 1);
    get("inspect-text").textContent = i < 0 ? this.hint(c) : this.sentence(frame, c, i, order.indexOf(i) + 1);
    this.showTerms(frame, c, i);
    this.drawHorizon(frame, i);
    const free = order.filter((k) => !c.collided[k]).map((k) => c.terms[c.width * (k + 1) - 2]);
    this.histogram(this.costs, free, "");
    const shares = order.map((k) => 100 * c.terms[c.width * (k + 1) - 1]);
    this.histogram(this.weights, shares, "%");
    this.drawEffective(frame);
    this.drawInputs(frame);
  }

  private hint(c: Candidates) {
    const collided = c.collided.filter((v) => v > 0).length;
    const count = `${c.count} of ${scalar("samples")} samples are shown; ${collided} of them collide.`;
    return count + " Click one in the scene (Select), or enter its rank.";
  }

  private sentence(frame: Frame, c: Candidates, i: number, rank: number) {
    const weight = percent(c.terms[c.width * (i + 1) - 1]);
    const at = collisionPoint(frame, i);
    const time =
      at === undefined ? "" : ` after ${(at * scalar("prediction_step")).toFixed(2)} s, at the cross`;
    const hit = at === undefined ? "" : bodyHit(frame, i, at);
    const end = c.collided[i] ? `It collides${hit && ` with ${hit}`}${time}.` : "It does not collide.";
    return `Rank ${rank} of ${c.count} by cost, weight ${weight}. ${end}`;
  }

  private showTerms(frame: Frame, c: Candidates, i: number) {
    const names = costTerms();
    const isCar = !page.hello?.problem;
    const plan = names
      .slice(0, -1)
      .map((name) => scalar(isCar ? `${name}_cost` : `cost.${name}`, frame.scalars));
    plan.push(plan.reduce((a, b) => a + b, 0));
    const rows = names.map((name, k) => {
      const candidate = i < 0 ? "" : short(c.terms[c.width * i + k]);
      const cells = [plan[k], candidate].map((v) =>
        make("td", { className: "n" }, typeof v === "number" ? short(v) : v),
      );
      const mark = make("i", { className: "swatch" });
      mark.style.background = k < names.length - 1 ? `var(--${looks[k % looks.length][0]})` : "none";
      return make("tr", {}, make("td", {}, mark, name), ...cells);
    });
    get("inspect-terms").replaceChildren(...rows);
  }

  private drawHorizon({ stepCosts }: Frame, i: number) {
    this.horizon.box.hidden = !stepCosts;
    if (!stepCosts) return;
    const { terms, points, costs } = stepCosts;
    const of = (trajectory: number, term: number) =>
      Array.from({ length: points }, (_, p) => costs[(trajectory * points + p) * terms + term]);
    const all = Array.from({ length: terms }, (_, k) => k);
    const isKnown = i >= 0 && costs.length >= (2 + i) * points * terms;
    const shown = [...all.map((k) => of(0, k)), ...(isKnown ? all.map((k) => of(1 + i, k)) : [])];
    const line = (k: number) => ({
      stroke: css(`--${looks[(k % terms) % looks.length][0]}`),
      dash: k < terms ? undefined : [2, 3],
    });
    this.drawLines(this.horizon, "s", this.times(points), shown, line);
  }

  private times = (points: number) =>
    Array.from({ length: points }, (_, p) => +(p * scalar("prediction_step")).toFixed(4));

  private drawLines(
    chart: Chart,
    unit: string,
    x: number[],
    lines: number[][],
    line: (k: number) => uPlot.Series,
    options: Partial<uPlot.Options> = {},
  ) {
    if (chart.width < 50) return;
    chart.draw(unit, [x, ...lines], {
      scales: { x: { time: false }, y: { range: padded } },
      series: [{}, ...lines.map((_, k) => ({ width: 1.6, points: { show: false }, ...line(k) }))],
      ...options,
    });
  }

  private drawEffective({ effectiveSamples, scalars }: Frame) {
    this.effective.box.hidden = !effectiveSamples;
    if (!effectiveSamples) return;
    const [x, y] = [0, 1].map((k) => Array.from(effectiveSamples).filter((_, i) => i % 2 === k));
    const temperatures = x.map((v) => +v.toPrecision(3));
    this.drawLines(this.effective, "", temperatures, [y], () => ({ stroke: css("--blue") }), {
      scales: { x: { time: false, distr: 3 }, y: { range: (_u, _a, b) => [0, Math.max(4, b * 1.1)] } },
      hooks: { draw: [(u) => vertical(u, scalar("temperature", scalars), "--warn", [5, 4])] },
    });
  }

  /** Draws the inputs of each step: those of the plan, and of the nominal sequence before and after. */
  private drawInputs({ inputs: all }: Frame) {
    const names = page.hello?.problem?.inputs ?? ["steering, rad", "acceleration, m/s²"];
    const count = all?.inputs ?? 0;
    while (this.inputs.length < count) {
      const name = names[this.inputs.length];
      const title = `Input ${name}: plan solid, nominal dashed, its guide at first dotted`;
      this.inputs.push(new Chart(get("inspect-charts"), title, []));
    }
    const dashes = [undefined, [6, 3], [2, 3]];
    const colours = ["accent", "text", "violet"];
    for (const [k, chart] of this.inputs.entries()) {
      chart.box.hidden = k >= count;
      if (!all || k >= count) continue;
      const { steps, values } = all;
      const sequences = values.length / (steps * count);
      const lines = Array.from({ length: sequences }, (_, s) =>
        Array.from({ length: steps }, (_, p) => values[(s * steps + p) * count + k]),
      );
      const line = (s: number) => ({ stroke: css(`--${colours[s]}`), dash: dashes[s] });
      this.drawLines(chart, "s", this.times(steps), lines, line);
    }
  }

  private histogram(chart: Chart, values: number[], unit: string) {
    const finite = values.filter(Number.isFinite).sort((a, b) => a - b);
    chart.box.hidden = finite.length < 2;
    if (finite.length < 2 || chart.width < 50) return;
    const [low, high] = [finite[0], finite[Math.floor(0.98 * (finite.length - 1))]];
    const width = Math.max(1e-12, high - low) / bins;
    const counts = new Array<number>(bins).fill(0);
    for (const v of finite) counts[Math.min(bins - 1, Math.floor((v - low) / width))] += 1;
    const bars = { stroke: css("--blue"), fill: css("--blue") + "55", width: 1, points: { show: false } };
    chart.draw(unit, [counts.map((_, k) => low + (k + 0.5) * width), counts], {
      scales: { x: { time: false }, y: { range: (_u, _a, b) => [0, Math.max(4, b * 1.15)] } },
      series: [{}, { ...bars, paths: uPlot.paths.bars!({ size: [0.9] }) }],
    });
  }
}
