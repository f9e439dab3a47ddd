import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Frame, Hello } from "./protocol";

interface Line { name: string; label: string; colour: string; dash?: number[]; right?: boolean; digits?: number }
interface Strip { title: string; unit: string; lines: Line[]; scale?: number }

// Colours tell apart with any colour vision: they differ in lightness as well, and one of each pair is dashed.
const strips: Strip[] = [
  { title: "Cost of the plan", unit: "", lines: [{ name: "distance_cost", label: "distance", colour: "--blue" }, { name: "yaw_cost", label: "yaw", colour: "--violet", dash: [6, 3] }, { name: "collision_cost", label: "collision", colour: "--bad" }] },
  { title: "Steering", unit: "rad", lines: [{ name: "command_steer", label: "command", colour: "--accent", digits: 3 }, { name: "steer", label: "wheels", colour: "--text", dash: [5, 3], digits: 3 }] },
  { title: "Speed", unit: "m/s", lines: [{ name: "command_speed", label: "command", colour: "--accent", digits: 2 }, { name: "speed", label: "car", colour: "--text", dash: [5, 3], digits: 2 }] },
  { title: "Samples", unit: "", lines: [{ name: "effective_samples", label: "ESS", colour: "--blue", digits: 0 }, { name: "temperature", label: "temperature", colour: "--warn", dash: [5, 3], right: true, digits: 2 }] },
  { title: "Collided candidates", unit: "%", scale: 100, lines: [{ name: "collided_share", label: "share", colour: "--bad", digits: 0 }] },
  { title: "Clearance", unit: "m", lines: [{ name: "clearance", label: "to wall or obstacle", colour: "--accent", digits: 2 }] },
];

const span = 20; // s that the strips show
const gap = 0.5; // s without a frame that are drawn as a gap

function css(name: string) { return getComputedStyle(document.documentElement).getPropertyValue(name).trim(); }

interface Plotted { strip: Strip; plot?: uPlot; holder: HTMLElement; values: HTMLElement[]; columns: number[][] }

/** Strip charts of the last seconds, the covariance along the plan, and how long solves took. */
export class Charts {
  private times: number[] = [];
  private readonly plotted: Plotted[] = [];
  private readonly covariance: { holder: HTMLElement; plot?: uPlot };
  private readonly histogram: { holder: HTMLElement; plot?: uPlot; value: HTMLElement };
  private ticks: { tick: number; ms: number }[] = [];
  private deadline = 25;
  private latest?: Frame;
  private width = 0;
  private drawn = 0;

  constructor(private readonly root: HTMLElement) {
    for (const strip of strips) {
      const { holder, values } = this.frame(strip.title + (strip.unit ? ", " + strip.unit : ""), strip.lines);
      this.plotted.push({ strip, holder, values, columns: strip.lines.map(() => []) });
    }
    this.covariance = this.frame("Standard deviation of the steering along the plan, rad", []);
    const h = this.frame("Planner time, last 500 ticks, ms", [{ name: "", label: "", colour: "" }]);
    this.histogram = { holder: h.holder, value: h.values[0] };
    new ResizeObserver(() => this.rebuild()).observe(root);
  }

  private frame(title: string, lines: Line[]) {
    const box = document.createElement("div");
    box.className = "chart";
    const head = document.createElement("h3");
    head.append(title);
    const values = lines.map((line) => {
      const em = document.createElement("em"), mark = document.createElement("i"), value = document.createElement("span");
      em.className = "value";
      if (line.colour) { mark.style.background = `var(${line.colour})`; em.append(mark); }
      value.className = "numbers";
      em.append(value);
      head.append(em);
      return value;
    });
    const holder = document.createElement("div");
    box.append(head, holder);
    this.root.append(box);
    return { holder, values };
  }

  rebuild() {
    const width = Math.floor(this.plotted[0].holder.clientWidth);
    if (width < 50) return;
    this.width = width;
    const axis = (over: Partial<uPlot.Axis> = {}): uPlot.Axis => ({ stroke: css("--soft"), grid: { stroke: css("--line"), width: 1 }, ticks: { show: false }, font: "10px system-ui, sans-serif", size: 40, gap: 3, ...over });
    for (const p of this.plotted) {
      p.plot?.destroy();
      const right = p.strip.lines.some((l) => l.right);
      p.plot = new uPlot({
        width, height: 104, cursor: { show: true, y: false, drag: { x: false, y: false }, sync: { key: "slalom" } }, legend: { show: false },
        scales: { x: { time: false }, y: { range: (_u, a, b) => pad(a, b) }, r: { range: (_u, a, b) => pad(a, b) } },
        axes: [axis({ size: 18, values: (_u, all) => all.map((v) => v + " s") }), axis(), ...(right ? [axis({ side: 1, scale: "r", grid: { show: false } })] : [])],
        series: [{}, ...p.strip.lines.map((l) => ({ stroke: css(l.colour), width: 1.6, dash: l.dash, scale: l.right ? "r" : "y", points: { show: false } }))],
      }, this.data(p), p.holder);
    }
    this.covariance.plot?.destroy();
    this.covariance.plot = new uPlot({
      width, height: 96, cursor: { show: false }, legend: { show: false }, scales: { x: { time: false }, y: { range: (_u, _a, b) => [0, (b || 0.1) * 1.15] } },
      axes: [axis({ size: 18, values: (_u, all) => all.map((v) => v + " s") }), axis()],
      series: [{}, { stroke: css("--accent"), fill: css("--accent") + "33", width: 1.6, paths: uPlot.paths.stepped!({ align: 1 }), points: { show: false } }],
    }, [[0], [0]], this.covariance.holder);
    this.histogram.plot?.destroy();
    this.histogram.plot = new uPlot({
      width, height: 96, cursor: { show: false }, legend: { show: false }, scales: { x: { time: false }, y: { range: (_u, _a, b) => [0, Math.max(4, b * 1.15)] } },
      axes: [axis({ size: 18, values: (_u, all) => all.map((v) => v + " ms") }), axis()],
      series: [{}, { stroke: css("--blue"), fill: css("--blue") + "55", width: 1, paths: uPlot.paths.bars!({ size: [0.9] }), points: { show: false } }],
      hooks: { draw: [(u) => this.drawDeadline(u)] },
    }, [[0], [0]], this.histogram.holder);
    this.draw(true);
  }

  private drawDeadline(u: uPlot) {
    const x = u.valToPos(this.deadline, "x", true), { top, height, left, width } = u.bbox;
    if (x < left || x > left + width) return;
    u.ctx.save();
    u.ctx.strokeStyle = css("--bad");
    u.ctx.setLineDash([5, 4]);
    u.ctx.lineWidth = 1.5 * devicePixelRatio;
    u.ctx.beginPath();
    u.ctx.moveTo(x, top);
    u.ctx.lineTo(x, top + height);
    u.ctx.stroke();
    u.ctx.restore();
  }

  private data(p: Plotted): uPlot.AlignedData { return [this.times, ...p.columns] as uPlot.AlignedData; }

  clear() {
    this.times = [];
    for (const p of this.plotted) p.columns = p.strip.lines.map(() => []);
    this.ticks = [];
  }

  add(frame: Frame, hello: Hello) {
    const at = (name: string) => frame.scalars[hello.scalars.indexOf(name)];
    const time = at("time"), tick = at("tick");
    let keep = this.times.length;
    while (keep > 0 && this.times[keep - 1] >= time - 1e-9) --keep;
    if (keep < this.times.length) {
      this.times.length = keep;
      for (const p of this.plotted) for (const c of p.columns) c.length = keep;
      this.ticks = this.ticks.filter((t) => t.tick < tick);
    }
    if (this.times.length && time - this.times[this.times.length - 1] > gap) { // nothing is known of what lies between
      this.times.push(time - 1e-6);
      for (const p of this.plotted) for (const c of p.columns) c.push(null as unknown as number);
    }
    this.times.push(time);
    for (const p of this.plotted) p.strip.lines.forEach((l, i) => { const v = at(l.name); p.columns[i].push(Number.isFinite(v) ? v * (p.strip.scale ?? 1) : (null as unknown as number)); });
    let old = 0;
    while (this.times[old] < time - span) ++old;
    if (old > 0) {
      this.times.splice(0, old);
      for (const p of this.plotted) for (const c of p.columns) c.splice(0, old);
    }
    if (Number.isFinite(at("tick_ms"))) this.ticks.push({ tick, ms: at("tick_ms") });
    if (this.ticks.length > 500) this.ticks.shift();
    this.deadline = at("deadline_ms");
    this.latest = frame;
    this.step = at("prediction_step");
    this.samples = at("samples");
  }
  private samples = 0;
  private step = 0.05;

  /** At most ten times a second: nobody reads charts faster. */
  draw(now = false) {
    const time = performance.now();
    if (!now && time - this.drawn < 100) return;
    if (this.root.offsetParent === null || !this.width) return;
    this.drawn = time;
    for (const p of this.plotted) {
      p.plot?.setData(this.data(p));
      p.strip.lines.forEach((l, i) => {
        const v = p.columns[i].at(-1);
        const of = l.name === "effective_samples" && this.samples > 0 ? ` of ${this.samples}` : "";
        p.values[i].textContent = `${l.label} ${v == null ? "–" : v.toFixed(l.digits ?? 2)}${of}`;
      });
    }
    const c = this.latest?.covariance;
    if (c && c.length) {
      const x = Array.from({ length: c.length + 1 }, (_, i) => +(i * this.step).toFixed(4)), y = Array.from(c, Math.sqrt);
      this.covariance.plot?.setData([x, [...y, y[y.length - 1]]]);
    }
    this.histogram.holder.parentElement!.hidden = !this.ticks.length;
    if (this.ticks.length) {
      const all = this.ticks.map((t) => t.ms).sort((a, b) => a - b);
      const top = Math.max(2, all[Math.floor(0.995 * (all.length - 1))] * 1.3), bins = 36, counts = new Array(bins).fill(0);
      for (const v of all) counts[Math.min(bins - 1, Math.floor((v / top) * bins))] += 1;
      this.histogram.plot?.setData([counts.map((_, i) => ((i + 0.5) * top) / bins), counts]);
      const q = (p: number) => all[Math.floor(p * (all.length - 1))].toFixed(2), misses = all.filter((v) => v > this.deadline).length;
      this.histogram.value.textContent = `median ${q(0.5)} · p99 ${q(0.99)} · deadline ${this.deadline.toFixed(0)} · missed ${misses}`;
    }
  }
}

function pad(a: number | null, b: number | null): [number, number] {
  if (a == null || b == null) return [0, 1];
  const room = Math.max(0.08 * (b - a), 1e-3 * Math.max(1, Math.abs(b)));
  return [a - room, b + room];
}
