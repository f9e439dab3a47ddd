import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Past } from "../past";
import type { Frame, Hello } from "../protocol";
import { Accelerations } from "./accelerations";
import { needsEstimates, strips, type Line, type Strip } from "./strips";

const span = 20; // s that the strips show
const max_ticks = 500; // of the histogram

function css(name: string) { return getComputedStyle(document.documentElement).getPropertyValue(name).trim(); }

interface Plotted { strip: Strip; plot?: uPlot; box: HTMLElement; holder: HTMLElement; values: HTMLElement[]; columns: (number | null)[][] }

interface Setting {
  past: Past;
  /** The time under the pointer (s), or undefined: the page shows it in the scene and on the slider. */
  hovered(time: number | undefined): void;
  /** A click on a chart. */
  chosen(time: number): void;
}

/** Strip charts of the last seconds, the covariance along the plan, and how long planner updates took. */
export class Charts {
  private times: number[] = [];
  private positions: number[] = [];
  private readonly plotted: Plotted[] = [];
  private readonly covariance: { holder: HTMLElement; plot?: uPlot };
  private readonly histogram: { holder: HTMLElement; plot?: uPlot; value: HTMLElement };
  private readonly accelerations: Accelerations;
  private deadline = 25;
  private latest?: Frame;
  private hello?: Hello;
  private shown = 0; // position
  private period = 0.025; // s between two steps
  private cursor?: number; // s
  private width = 0;
  private drawn = 0; // ms, when the charts were drawn
  private took = 0; // ms, to draw them

  constructor(private readonly root: HTMLElement, private readonly setting: Setting) {
    for (const strip of strips) {
      const { box, holder, values } = this.frame(strip.title + (strip.unit ? ", " + strip.unit : ""), strip.lines);
      box.hidden = needsEstimates(strip);
      this.plotted.push({ strip, box, holder, values, columns: strip.lines.map(() => []) });
    }
    this.covariance = this.frame("Standard deviation of the steering along the plan, rad", []);
    const h = this.frame(`Planner time, last ${max_ticks} ticks, ms`, [{ name: "", label: "", colour: "" }]);
    this.histogram = { holder: h.holder, value: h.values[0] };
    const a = this.frame("Acceleration, m/s²", [{ name: "", label: "", colour: "" }]);
    this.accelerations = new Accelerations(a.holder, a.values[0]);
    new ResizeObserver(() => this.rebuild()).observe(root);
  }

  private frame(title: string, lines: Line[]) {
    const box = document.createElement("div");
    box.className = "chart";
    const head = document.createElement("h2");
    head.append(title);
    const values = lines.map((line) => {
      const em = document.createElement("em"), mark = document.createElement("i"), value = document.createElement("span");
      em.className = "value";
      if (line.colour) {
        const [on, off] = line.dash ?? [1, 0], colour = `var(${line.colour})`;
        mark.style.background = `repeating-linear-gradient(90deg, ${colour} 0 ${on}px, transparent ${on}px ${on + off}px)`;
        em.append(mark);
      }
      value.className = "numbers";
      em.append(value);
      head.append(em);
      return value;
    });
    const holder = document.createElement("div");
    box.append(head, holder);
    this.root.append(box);
    return { box, holder, values };
  }

  rebuild() {
    const width = Math.floor(this.plotted[0].holder.clientWidth);
    if (width < 50) return;
    this.width = width;
    const axis = (over: Partial<uPlot.Axis> = {}): uPlot.Axis => ({ stroke: css("--soft"), grid: { stroke: css("--line"), width: 1 }, ticks: { show: false }, font: "10px system-ui, sans-serif", size: 40, gap: 3, ...over });
    const upright = { space: 18 }; // px between two values of an axis, so that there are at least three
    for (const p of this.plotted) {
      p.plot?.destroy();
      const right = p.strip.lines.some((l) => l.right);
      p.plot = new uPlot({
        width, height: 104, cursor: { show: true, y: false, drag: { x: false, y: false }, points: { size: 7 } }, legend: { show: false },
        scales: { x: { time: false, range: () => this.range() }, y: { range: (_u, a, b) => pad(a, b) }, r: { range: (_u, a, b) => pad(a, b) } },
        axes: [axis({ size: 18, values: (_u, all) => all.map((v) => v + " s") }), axis(upright), ...(right ? [axis({ side: 1, scale: "r", grid: { show: false }, ...upright })] : [])],
        series: [{}, ...p.strip.lines.map((l) => ({ stroke: css(l.colour), width: 1.6, dash: l.dash, scale: l.right ? "r" : "y", points: { show: false } }))],
        hooks: { draw: [(u) => this.drawShown(u)] },
      }, this.data(p), p.holder);
      this.watch(p.plot);
    }
    this.covariance.plot?.destroy();
    this.covariance.plot = new uPlot({
      width, height: 96, cursor: { show: false }, legend: { show: false }, scales: { x: { time: false }, y: { range: (_u, _a, b) => [0, (b || 0.1) * 1.15] } },
      axes: [axis({ size: 18, values: (_u, all) => all.map((v) => v + " s") }), axis(upright)],
      series: [{}, { stroke: css("--accent"), fill: css("--accent") + "33", width: 1.6, paths: uPlot.paths.stepped!({ align: 1 }), points: { show: false } }],
    }, [[0], [0]], this.covariance.holder);
    this.histogram.plot?.destroy();
    this.histogram.plot = new uPlot({
      width, height: 96, cursor: { show: false }, legend: { show: false }, scales: { x: { time: false }, y: { range: (_u, _a, b) => [0, Math.max(4, b * 1.15)] } },
      axes: [axis({ size: 18, values: (_u, all) => all.map((v) => v + " ms") }), axis(upright)],
      series: [{}, { stroke: css("--blue"), fill: css("--blue") + "55", width: 1, paths: uPlot.paths.bars!({ size: [0.9] }), points: { show: false } }],
      hooks: { draw: [(u) => vertical(u, this.deadline, "--bad", [5, 4])] },
    }, [[0], [0]], this.histogram.holder);
    this.draw(true);
  }

  /** The pointer over a chart. */
  private watch(plot: uPlot) {
    const time = (e: PointerEvent | MouseEvent) => plot.posToVal(e.clientX - plot.over.getBoundingClientRect().left, "x");
    plot.over.addEventListener("pointermove", (e) => this.setting.hovered(time(e)));
    plot.over.addEventListener("pointerleave", () => this.setting.hovered(undefined));
    // The place of a click is rounded to whole pixels, that of the cursor is not; what the cursor shows is chosen.
    plot.over.addEventListener("click", (e) => this.setting.chosen(this.cursor ?? time(e)));
  }

  /** Puts the cursor of all charts to a time (s), or takes it away. */
  showCursor(time: number | undefined) {
    this.cursor = time;
    for (const { plot } of this.plotted) plot?.setCursor({ left: time === undefined ? -10 : plot.valToPos(time, "x"), top: time === undefined ? -10 : 0 }, false);
    this.showValues();
  }

  private range(): [number, number] {
    const last = this.times.at(-1) ?? 0;
    return [Math.max(0, last - span), Math.max(1, last)];
  }

  /** The tick that the scene shows, if it is not the newest. */
  private drawShown(u: uPlot) {
    const time = this.times[this.positions.indexOf(this.shown)];
    if (time !== undefined && this.shown < this.setting.past.newest) vertical(u, time, "--text", [2, 3]);
  }

  private data(p: Plotted): uPlot.AlignedData { return [this.times, ...p.columns] as uPlot.AlignedData; }

  clear() { this.times = []; this.positions = []; for (const p of this.plotted) p.columns = p.strip.lines.map(() => []); }

  /** A frame at a position of the past is shown; `period`: s between two steps. */
  show(frame: Frame, hello: Hello, position: number, period: number) {
    this.latest = frame;
    this.hello = hello;
    this.shown = position;
    this.period = period;
    this.deadline = frame.scalars[hello.scalars.indexOf("deadline_ms")];
  }

  /** The columns of the window that is shown: the newest seconds, or those around the tick that is shown. */
  private collect(hello: Hello) {
    const { past } = this.setting, { period } = this, length = Math.round(span / period);
    const last = this.shown >= past.newest - length ? past.newest : this.shown + Math.round(length / 2);
    const first = Math.max(past.oldest, last - length);
    this.clear();
    const index = this.plotted.map((p) => p.strip.lines.map((l) => hello.scalars.indexOf(l.name)));
    for (let position = first; position <= last; ++position) {
      const row = past.at(position);
      this.times.push(+(position * period).toFixed(6));
      this.positions.push(position);
      this.plotted.forEach((p, k) => p.strip.lines.forEach((l, i) => { const v = row ? row[index[k][i]] : NaN; p.columns[i].push(Number.isFinite(v) ? v * (l.scale ?? 1) : null); }));
    }
    for (const p of this.plotted) if (needsEstimates(p.strip)) p.box.hidden = !p.strip.lines.some((l, i) => (l.name.endsWith("_estimate") || l.name === "grip_used") && p.columns[i].some((v) => v !== null));
  }

  /** At most ten times a second, and less often where a draw takes long: at most a sixth of the time. */
  draw(now = false) {
    const time = performance.now();
    if (!now && time - this.drawn < Math.max(100, 6 * this.took)) return;
    if (this.root.offsetParent === null || !this.width || !this.hello || !this.latest) return;
    this.drawn = time;
    this.collect(this.hello);
    for (const p of this.plotted) if (!p.box.hidden) p.plot?.setData(this.data(p));
    if (this.cursor !== undefined) this.showCursor(this.cursor);
    this.showValues();
    const c = this.latest.covariance, step = this.scalar("prediction_step");
    if (c && c.length) {
      const x = Array.from({ length: c.length + 1 }, (_, i) => +(i * step).toFixed(4)), y = Array.from(c, Math.sqrt);
      this.covariance.plot?.setData([x, [...y, y[y.length - 1]]]);
    }
    this.drawHistogram();
    this.accelerations.draw(this.positions.map((position) => this.setting.past.at(position)), this.positions.indexOf(this.shown), this.period, this.hello.scalars, css);
    this.took = performance.now() - time;
  }

  private scalar(name: string) { return this.latest!.scalars[this.hello!.scalars.indexOf(name)]; }

  /** The values at the cursor, else at the tick that is shown. */
  private showValues() {
    if (!this.hello || !this.latest) return;
    const position = this.cursor === undefined ? this.shown : Math.round(this.cursor / this.period), i = this.positions.indexOf(position);
    for (const p of this.plotted)
      p.strip.lines.forEach((l, k) => {
        const v = i < 0 ? null : p.columns[k][i], samples = this.scalar("samples");
        const of = l.name === "effective_samples" && samples > 0 ? ` of ${samples}` : "";
        p.values[k].textContent = `${l.label} ${v == null ? "–" : v.toFixed(l.digits ?? 2)}${of}`;
      });
  }

  private drawHistogram() {
    const { past } = this.setting, index = this.hello!.scalars.indexOf("tick_ms"), all: number[] = [];
    for (let position = past.newest; position >= past.oldest && all.length < max_ticks; --position) { const v = past.at(position)?.[index] ?? NaN; if (Number.isFinite(v)) all.push(v); }
    this.histogram.holder.parentElement!.hidden = !all.length;
    if (!all.length) return;
    all.sort((a, b) => a - b);
    const top = Math.max(2, all[Math.floor(0.995 * (all.length - 1))] * 1.3), bins = 36, counts = new Array(bins).fill(0);
    for (const v of all) counts[Math.min(bins - 1, Math.floor((v / top) * bins))] += 1;
    this.histogram.plot?.setData([counts.map((_, i) => ((i + 0.5) * top) / bins), counts]);
    const q = (p: number) => all[Math.floor(p * (all.length - 1))].toFixed(2), misses = all.filter((v) => v > this.deadline).length;
    this.histogram.value.textContent = `median ${q(0.5)} · p99 ${q(0.99)} · deadline ${this.deadline.toFixed(0)} · missed ${misses}`;
  }

  /** What the charts show, as comma-separated values with the names of the scalars. */
  csv(): string {
    if (this.hello) this.collect(this.hello);
    const shown = this.plotted.filter((p) => !p.box.hidden).flatMap((p) => p.strip.lines.map((l, i) => ({ l, column: p.columns[i] })));
    const rows = this.positions.map((position, i) => [position, this.times[i], ...shown.map(({ l, column }) => (column[i] === null ? "" : column[i]! / (l.scale ?? 1)))].join());
    return [["tick", "time", ...shown.map(({ l }) => l.name)].join(), ...rows].join("\n") + "\n";
  }
}

/** A dashed vertical line at a value of the x axis. */
function vertical(u: uPlot, value: number, colour: string, dash: number[]) {
  const x = u.valToPos(value, "x", true), { top, height, left, width } = u.bbox;
  if (x < left || x > left + width) return;
  u.ctx.save();
  u.ctx.strokeStyle = css(colour);
  u.ctx.setLineDash(dash.map((d) => d * devicePixelRatio));
  u.ctx.lineWidth = 1.5 * devicePixelRatio;
  u.ctx.beginPath();
  u.ctx.moveTo(x, top);
  u.ctx.lineTo(x, top + height);
  u.ctx.stroke();
  u.ctx.restore();
}

function pad(a: number | null, b: number | null): [number, number] {
  if (a == null || b == null) return [0, 1];
  const room = Math.max(0.08 * (b - a), b - a < 1e-6 ? 0.1 * Math.max(1, Math.abs(b)) : 0);
  return [a - room, b + room];
}
