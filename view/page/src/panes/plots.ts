import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { make } from "../dom";
import type { Line } from "./strips";

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
    this.box.append(make("h2", {}, title, ...legend), this.holder);
    root.append(this.box);
  }

  /** Replaces the plot; `unit` stands beside the values of the x axis. */
  draw(unit: string, data: uPlot.AlignedData, options: Partial<uPlot.Options>) {
    this.plot?.destroy();
    const bottom = axis({
      size: 18,
      space: 50,
      values: (_u, all) => all.map((v) => (v === null ? "" : `${v} ${unit}`)),
    });
    const usual = {
      cursor: { show: false },
      legend: { show: false },
      series: [],
      ...options,
      axes: [bottom, axis(), ...(options.axes ?? [])],
    };
    this.plot = new uPlot({ width: this.width, height: 96, ...usual }, data, this.holder);
  }

  get width() {
    return Math.floor(this.holder.clientWidth);
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
