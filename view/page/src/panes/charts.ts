import uPlot from "uplot";
import type { Past } from "../past";
import { get } from "../dom";
import { page, period, scalar } from "../page";
import { axis, Chart, css, padded, vertical } from "./plots";
import type { Hello } from "../protocol";
import { isEstimate, stripsOf, unitOf, type Strip } from "./strips";

const span = 20; // s that the strips show
const max_ticks = 500; // ticks in the histogram
const bins = 36; // bins of the histogram
const none = new Float64Array(); // scalars of a step that is not known

/** A strip chart with its columns of values. */
interface Plotted {
  strip: Strip;
  chart: Chart;
  columns: (number | null)[][];
  ghost: (number | null)[][]; // the same of the second controller
}

interface Setting {
  past: Past;
  ghostPast: Past;
  /** Called with the time under the pointer (s), if it is over a chart. */
  hovered(time: number | undefined): void;
  /** Called with the time at which a chart was clicked. */
  chosen(time: number): void;
}

/** Strip charts of the last seconds, the covariance along the plan, a histogram of the planner's times. */
export class Charts {
  private times: number[] = [];
  private positions: number[] = [];
  private plotted: Plotted[] = [];
  private covariance!: Chart;
  private histogram!: Chart;
  private cursor?: number; // s
  private window?: [number, number]; // s
  private isLog = false;
  private isBuilt = false;
  private drawn = 0; // ms, when the charts were drawn
  private took = 0; // ms, to draw them

  constructor(
    private readonly root: HTMLElement,
    private readonly setting: Setting,
  ) {
    new ResizeObserver(() => this.rebuild()).observe(root);
  }

  /** Makes the charts of what a server tells. */
  describe(hello: Hello) {
    const { root } = this;
    root.replaceChildren();
    this.plotted = stripsOf(hello).map((strip) => {
      const chart = new Chart(root, strip.title, strip.lines);
      chart.box.hidden = strip.lines.some(isEstimate);
      return { strip, chart, columns: strip.lines.map(() => []), ghost: [] };
    });
    const input = hello.problem?.inputs[0] ?? "the steering, rad";
    const [name, unit] = input.split(", ");
    const deviation = `Standard deviation of ${name} along the plan${unit ? ", " + unit : ""}`;
    this.covariance = new Chart(root, deviation, []);
    this.histogram = new Chart(root, `Planner time, last ${max_ticks} ticks, ms`, [{ colour: "" }]);
    this.rebuild();
  }

  /** Makes the plots anew: the size of the pane or the theme has changed. */
  rebuild() {
    if (!this.plotted.length || this.plotted[0].chart.width < 50) return;
    this.isBuilt = true;
    for (const p of this.plotted) this.rebuildStrip(p);
    const points = { show: false };
    const [accent, blue] = [css("--accent"), css("--blue")];
    const steps = { stroke: accent, fill: accent + "33", width: 1.6, points };
    this.covariance.draw("s", [[0], [0]], {
      scales: { x: { time: false }, y: { range: (_u, _a, b) => [0, (b || 0.1) * 1.15] } },
      series: [{}, { ...steps, paths: uPlot.paths.stepped!({ align: 1 }) }],
    });
    const bars = { stroke: blue, fill: blue + "55", width: 1, points };
    this.histogram.draw("ms", [[0], [0]], {
      scales: { x: { time: false }, y: { range: (_u, _a, b) => [0, Math.max(4, b * 1.15)] } },
      series: [{}, { ...bars, paths: uPlot.paths.bars!({ size: [0.9] }) }],
      hooks: { draw: [(u) => vertical(u, scalar("deadline_ms"), "--bad", [5, 4])] },
    });
    this.draw(true);
  }

  private rebuildStrip(p: Plotted) {
    const usual = { width: 1.6, points: { show: false } };
    const series = p.strip.lines.map(({ colour, dash, right }, i) => {
      return { ...usual, stroke: css(colour), dash, scale: right ? "r" : "y", show: p.chart.shown[i] };
    });
    const isTwofold = p.strip.lines.some((line) => line.right);
    p.chart.draw("s", this.data(p), {
      height: 104,
      cursor: { show: true, y: false, drag: { x: true, y: false, setScale: false }, points: { size: 7 } },
      scales: {
        x: { time: false, range: () => this.range() },
        y: this.isLog && p.strip.isCost ? { distr: 4, asinh: 0.1 } : { range: padded },
        r: { range: padded },
      },
      axes: isTwofold ? [axis({ side: 1, scale: "r", grid: { show: false } })] : [],
      series: [{}, ...series, ...series.map((each) => ({ ...each, width: 1, alpha: 0.45 }))],
      hooks: { draw: [(u) => this.drawShown(u)], setSelect: [(u) => this.zoomTo(u)] },
    });
    this.watch(p.chart.plot!);
  }

  /** Tells the page where the pointer is on a chart. */
  private watch(plot: uPlot) {
    const left = (e: MouseEvent) => e.clientX - plot.over.getBoundingClientRect().left;
    const time = (e: MouseEvent) => plot.posToVal(left(e), "x");
    plot.over.addEventListener("pointermove", (e) => this.setting.hovered(time(e)));
    plot.over.addEventListener("pointerleave", () => this.setting.hovered(undefined));
    // The place of a click is rounded to whole pixels, that of the cursor is not; the cursor counts.
    plot.over.addEventListener("click", (e) => {
      if (Math.abs(e.clientX - pressed) < 4) this.setting.chosen(this.cursor ?? time(e));
    });
    let pressed = 0;
    plot.over.addEventListener("pointerdown", (e) => (pressed = e.clientX));
  }

  /** Puts the cursor of all charts to a time (s), or takes it away. */
  showCursor(time: number | undefined) {
    this.cursor = time;
    for (const { plot } of this.plotted.map((p) => p.chart)) {
      const place =
        time === undefined ? { left: -10, top: -10 } : { left: plot?.valToPos(time, "x") ?? 0, top: 0 };
      plot?.setCursor(place, false);
    }
    this.showValues();
  }

  /** Shows the span that was dragged over, in all charts. */
  private zoomTo(u: uPlot) {
    const { left, width } = u.select;
    if (width < 4) return;
    this.zoom([u.posToVal(left, "x"), u.posToVal(left + width, "x")]);
    u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
  }
  /** Shows a span (s), or the newest seconds. */
  zoom(window?: [number, number]) {
    this.window = window;
    for (const id of ["earlier", "later", "zoom-out"]) get(id).hidden = !window;
    this.draw(true);
  }
  /** Moves the span that is shown by a share of its length. */
  pan(share: number) {
    const [from, to] = this.window ?? this.range();
    const way = share * (to - from);
    this.zoom([from + way, to + way]);
  }
  /** Shows costs on a logarithmic axis, or a linear one. */
  setLog(on: boolean) {
    this.isLog = on;
    this.rebuild();
  }

  private range(): [number, number] {
    if (this.window) return this.window;
    const last = this.times.at(-1) ?? 0;
    return [Math.max(0, last - span), Math.max(1, last)];
  }

  /** Marks the tick that the scene shows, if it is not the newest. */
  private drawShown(u: uPlot) {
    const time = this.times[this.positions.indexOf(page.position)];
    if (time !== undefined && page.position < this.setting.past.newest) vertical(u, time, "--text", [2, 3]);
  }

  private data(p: Plotted): uPlot.AlignedData {
    return [this.times, ...p.columns, ...p.ghost] as uPlot.AlignedData;
  }

  /** Collects the columns of the window: the newest seconds, or those around the tick that is shown. */
  private collect() {
    const { past, ghostPast } = this.setting;
    const length = Math.round(span / period());
    const [from, to] = (this.window ?? []).map((time) => Math.round(time / period()));
    const last =
      to ?? (page.position >= past.newest - length ? past.newest : page.position + Math.round(length / 2));
    this.times = [];
    this.positions = [];
    for (const p of this.plotted) [p.columns, p.ghost] = [0, 1].map(() => p.strip.lines.map(() => []));
    const index = this.plotted.map((p) => p.strip.lines.map((l) => page.hello!.scalars.indexOf(l.name)));
    for (let position = Math.max(past.oldest, from ?? last - length); position <= last; ++position) {
      this.times.push(+(position * period()).toFixed(6));
      this.positions.push(position);
      const [row, ghostRow] = [past.at(position), ghostPast.at(position)];
      for (const [k, { strip, columns, ghost }] of this.plotted.entries())
        for (const [i, line] of strip.lines.entries()) {
          const of = (from?: Float64Array) => {
            const v = from ? from[index[k][i]] : NaN;
            return Number.isFinite(v) ? v * (line.scale ?? 1) : null;
          };
          columns[i].push(of(row));
          ghost[i].push(of(ghostRow));
        }
    }
    // Without tyres that slip there are no estimates, and their charts are hidden.
    const isKnown = (p: Plotted, i: number) =>
      isEstimate(p.strip.lines[i]) && p.columns[i].some((v) => v !== null);
    for (const p of this.plotted)
      if (p.strip.lines.some(isEstimate)) p.chart.box.hidden = !p.strip.lines.some((_, i) => isKnown(p, i));
  }

  /** Draws at most ten times a second, and less often where it takes long: at most a sixth of the time. */
  draw(now = false) {
    const time = performance.now();
    if (!now && time - this.drawn < Math.max(100, 6 * this.took)) return;
    if (this.root.offsetParent === null || !this.isBuilt || !page.hello || !page.frame) return;
    this.drawn = time;
    this.collect();
    for (const p of this.plotted) if (!p.chart.box.hidden) p.chart.plot?.setData(this.data(p));
    if (this.cursor !== undefined) this.showCursor(this.cursor);
    this.showValues();
    const { covariance } = page.frame;
    if (covariance?.length) {
      const step = scalar("prediction_step");
      const x = Array.from({ length: covariance.length + 1 }, (_, i) => +(i * step).toFixed(4));
      const y = Array.from(covariance, Math.sqrt);
      this.covariance.plot?.setData([x, [...y, y[y.length - 1]]]);
    }
    this.drawHistogram();
    this.took = performance.now() - time;
  }

  /** Shows the values at the cursor, else at the tick that is shown. */
  private showValues() {
    if (!page.frame) return;
    const position = this.cursor === undefined ? page.position : Math.round(this.cursor / period());
    const i = this.positions.indexOf(position);
    const samples = scalar("samples");
    for (const { strip, chart, columns } of this.plotted)
      for (const [k, line] of strip.lines.entries()) {
        const v = i < 0 ? null : columns[k][i];
        const of = line.name === "effective_samples" && samples > 0 ? ` of ${samples}` : "";
        chart.values[k].textContent = `${line.label} ${v == null ? "–" : v.toFixed(line.digits ?? 2)}${of}`;
      }
  }

  private drawHistogram() {
    const { past } = this.setting;
    const times: number[] = [];
    for (let i = past.newest; i >= past.oldest && times.length < max_ticks; --i) {
      const v = scalar("tick_ms", past.at(i) ?? none);
      if (Number.isFinite(v)) times.push(v);
    }
    this.histogram.box.hidden = !times.length;
    if (!times.length) return;
    times.sort((a, b) => a - b);
    const quantile = (p: number) => times[Math.floor(p * (times.length - 1))];
    const top = Math.max(2, quantile(0.995) * 1.3);
    const counts = new Array<number>(bins).fill(0);
    for (const v of times) counts[Math.min(bins - 1, Math.floor((v / top) * bins))] += 1;
    this.histogram.plot?.setData([counts.map((_, i) => ((i + 0.5) * top) / bins), counts]);
    const parts = [`median ${quantile(0.5).toFixed(2)}`, `p99 ${quantile(0.99).toFixed(2)}`];
    const missed = times.filter((v) => v > scalar("deadline_ms")).length;
    parts.push(`deadline ${scalar("deadline_ms").toFixed(0)}`, `missed ${missed}`);
    this.histogram.values[0].textContent = parts.join(" · ");
  }

  /** The values of the charts as comma-separated values, with the names of the scalars. */
  csv(): string {
    if (page.hello) this.collect();
    const shown = this.plotted.filter((p) => !p.chart.box.hidden);
    const columns = shown.flatMap((p) =>
      p.strip.lines.flatMap((line, i) => {
        const unit = unitOf(p.strip, line);
        const ghost = { name: "ghost_" + line.name, unit, values: p.ghost[i] };
        const hasGhost = ghost.values.some((v) => v !== null);
        return [{ name: line.name, unit, values: p.columns[i] }, ...(hasGhost ? [ghost] : [])];
      }),
    );
    const rows = this.positions.map((position, i) => {
      return [position, this.times[i], ...columns.map(({ values }) => values[i] ?? "")];
    });
    const head = ["tick", "time [s]", ...columns.map(({ name, unit }) => name + (unit && ` [${unit}]`))];
    return [head, ...rows].map((row) => row.join()).join("\n") + "\n";
  }
}
