import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { make } from "../dom";
import { page, redraw } from "../page";
import { meaningOf, type Line } from "./strips";

const bins = 30; // bars of a histogram

/** The value of a CSS variable. */
export function css(name: string) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** A titled chart with a value for each of its lines. */
export class Chart {
  readonly box = make("div", { className: "chart" });
  readonly holder = make("div");
  readonly values: HTMLElement[];
  readonly shown: boolean[]; // lines
  plot?: uPlot;
  private made = ""; // as what the plot was made
  private width = 0; // pixels

  constructor(root: HTMLElement, title: string, lines: Pick<Line, "colour" | "dash">[]) {
    this.values = lines.map(() => make("span", { className: "numbers" }));
    this.shown = lines.map(() => true);
    const legend = lines.map(({ colour, dash }, i) => {
      const mark = make("i");
      const [on, off] = dash ?? [1, 0];
      const ends = `var(${colour}) 0 ${on}px, transparent ${on}px ${on + off}px`;
      mark.style.background = `repeating-linear-gradient(90deg, ${ends})`;
      if (!colour) return make("em", { className: "value" }, this.values[i]);
      const title = "Show or hide this line";
      const button = make("button", { className: "value", title }, mark, this.values[i]);
      button.setAttribute("aria-pressed", "true");
      button.onclick = () => {
        this.shown[i] = !this.shown[i];
        button.setAttribute("aria-pressed", String(this.shown[i]));
        for (const k of [i + 1, i + 1 + lines.length])
          // the line, and that of the ghost
          if (this.plot?.series[k]) this.plot.setSeries(k, { show: this.shown[i] });
      };
      return button;
    });
    this.box.append(make("h2", { title: meaningOf(title) }, title, ...legend), this.holder);
    new ResizeObserver(([{ contentRect }]) => {
      this.width = Math.floor(contentRect.width);
      redraw();
    }).observe(this.holder);
    root.append(this.box);
  }

  /**
   * Draws data; `unit` stands beside the values of the x axis. The plot is made anew where its size, the theme,
   * the number of lines or `variant` has changed.
   */
  draw(unit: string, data: uPlot.AlignedData, options: Partial<uPlot.Options>, variant = "") {
    const { width } = this;
    if (width < 50) return;
    const made = [width, page.theme!.dark, data.length, variant].join();
    if (this.made === made) return this.plot!.setData(data);
    this.made = made;
    this.plot?.destroy();
    const bottom = axis({
      size: 18,
      space: 50,
      values: (_u, all) => all.map((v) => (v === null ? "" : `${v} ${unit}`)),
    });
    const usual = { cursor: { show: false }, legend: { show: false }, height: 96, width, ...options };
    const scales = { x: { time: false }, y: { range: padded }, ...options.scales };
    const axes = [bottom, axis(), ...(options.axes ?? [])];
    const series = [{}, ...(options.series ?? [])].map((each) => ({ points: { show: false }, ...each }));
    this.plot = new uPlot({ ...usual, scales, axes, series }, data, this.holder);
  }

  /** Draws how often values occur between two values; those beyond the last count as there. */
  histogram(unit: string, values: number[], from: number, to: number, hooks: uPlot.Hooks.Arrays = {}) {
    const width = Math.max(1e-12, to - from) / bins;
    const counts = new Array<number>(bins).fill(0);
    for (const v of values) counts[Math.min(bins - 1, Math.floor((v - from) / width))] += 1;
    const blue = css("--blue");
    const bars = { stroke: blue, fill: blue + "55", width: 1, paths: uPlot.paths.bars!({ size: [0.9] }) };
    const x = counts.map((_, k) => from + (k + 0.5) * width);
    this.draw(unit, [x, counts], { scales: { y: { range: fromZero(4) } }, series: [bars], hooks });
  }
}
/** An axis; at least three values fit on an upright one. */
export function axis(over: Partial<uPlot.Axis> = {}): uPlot.Axis {
  const grid = { stroke: css("--line"), width: 1 };
  const font = "10px system-ui, sans-serif";
  return { stroke: css("--soft"), grid, ticks: { show: false }, font, size: 40, gap: 3, space: 18, ...over };
}

/** Draws a dashed vertical line at a value of the x axis. */
export function vertical(u: uPlot, value: number, colour: string, dash: number[]) {
  const x = u.valToPos(value, "x", true);
  const { top, height, left, width } = u.bbox;
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

/** A range of an axis with some room around the values. */
export function padded(_u: uPlot, a: number | null, b: number | null): [number, number] {
  if (a == null || b == null) return [0, 1];
  const room = Math.max(0.08 * (b - a), b - a < 1e-6 ? 0.1 * Math.max(1, Math.abs(b)) : 0);
  return [a - room, b + room];
}

/** A range of an axis from zero to at least a value. */
export const fromZero = (least: number) => (_u: uPlot, _a: number, b: number) =>
  [0, Math.max(least, b * 1.15)] as [number, number];
