import uPlot from "uplot";
import { send } from "../connection";
import { click, get, say } from "../dom";
import { on, page, period, scalar, tell } from "../page";
import { ghostPast, past } from "../past";
import { fileName } from "../scenario";
import { download } from "../toast";
import { axis, Chart, css, fromZero, padded, vertical } from "./plots";
import { stripsOf, unitOf, type Strip } from "./strips";

// Strip charts of the last seconds, the covariance along the plan, a histogram of the planner's times.

const span = 20; // s that the strips show
const most = 500; // ticks in the histogram

/** A strip chart with its columns of values. */
interface Plotted {
  strip: Strip;
  chart: Chart;
  columns: (number | null)[][];
  ghost: (number | null)[][]; // the same of the second controller
}

const root = get("charts");
let times: number[] = []; // s
let ticks: number[] = [];
let plotted: Plotted[] = [];
let covariance: Chart;
let histogram: Chart;
let window: [from: number, to: number] | undefined; // s; by default the newest seconds
let isLog = false;
let drawn = 0; // ms, when the charts were drawn
let took = 0; // ms, to draw them

on("hello", (hello) => {
  root.replaceChildren();
  plotted = stripsOf(hello).map((strip) => {
    const chart = new Chart(root, strip.title, strip.lines);
    return { strip, chart, columns: strip.lines.map(() => []), ghost: [] };
  });
  const [name, unit] = hello.inputs[0].split(", ");
  const deviation = `Standard deviation of ${name} along the plan${unit ? ", " + unit : ""}`;
  covariance = new Chart(root, deviation, []);
  histogram = new Chart(root, `Planner time, last ${most} ticks, ms`, [{ colour: "" }]);
});

const range = (): [number, number] => {
  const last = times.at(-1) ?? 0;
  return window ?? [Math.max(0, last - span), Math.max(1, last)];
};

/** Shows a span (s), or the newest seconds. */
function zoom(to?: [number, number]) {
  window = to;
  for (const id of ["earlier", "later", "zoom-out"]) get(id).hidden = !window;
  draw(true);
}
/** Moves the span that is shown by a share of its length. */
function pan(share: number) {
  const [from, to] = range();
  const way = share * (to - from);
  zoom([from + way, to + way]);
}
on("forgotten", () => zoom());
click("zoom-out", () => zoom());
click("earlier", () => pan(-0.5));
click("later", () => pan(0.5));
get("log").onchange = () => {
  isLog = get<HTMLInputElement>("log").checked;
  draw(true);
};
click("csv", () => download(`${fileName()}.csv`, csv(), "text/csv"));

/** Puts the cursor of all charts to the time under the pointer, and shows the values there. */
function showCursor(tick: number | undefined) {
  for (const { plot } of plotted.map((p) => p.chart)) {
    const left = tick === undefined ? -10 : (plot?.valToPos(tick * period(), "x") ?? 0);
    plot?.setCursor({ left, top: tick === undefined ? -10 : 0 }, false);
  }
  showValues();
}
on("cursor", showCursor);

/** Tells the page where the pointer is on a chart, and goes to a time that is clicked. */
function watch(plot: uPlot) {
  const { over } = plot;
  const tickAt = (e: MouseEvent) =>
    Math.round(plot.posToVal(e.clientX - over.getBoundingClientRect().left, "x") / period());
  let pressed = 0;
  over.onpointermove = (e) => tell("cursor", tickAt(e));
  over.onpointerleave = () => tell("cursor", undefined);
  over.onpointerdown = (e) => (pressed = e.clientX);
  // The place of a click is rounded to whole pixels, that of the cursor is not; the cursor counts.
  over.onclick = (e) => {
    if (Math.abs(e.clientX - pressed) < 4) send({ do: "seek", tick: page.cursor ?? tickAt(e) });
  };
}

/** Shows the span that was dragged over, in all charts. */
function zoomToSelected(u: uPlot) {
  const { left, width } = u.select;
  if (width < 4) return;
  zoom([u.posToVal(left, "x"), u.posToVal(left + width, "x")]);
  u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
}

/** Marks the tick that the scene shows, if it is not the newest. */
function markShown(u: uPlot) {
  const time = times[ticks.indexOf(scalar("tick"))];
  if (time !== undefined && scalar("tick") < past.newest) vertical(u, time, "--text", [2, 3]);
}

/** Collects the columns of the window: the newest seconds, or those around the tick that is shown. */
function collect() {
  const tick = scalar("tick");
  const length = Math.round(span / period());
  const [from, to] = (window ?? []).map((time) => Math.round(time / period()));
  const last = to ?? (tick >= past.newest - length ? past.newest : tick + Math.round(length / 2));
  const first = Math.max(past.oldest, from ?? last - length);
  ticks = Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => first + i);
  times = ticks.map((each) => +(each * period()).toFixed(6));
  const rows = [past, ghostPast].map((of) => ticks.map((each) => of.at(each)));
  for (const p of plotted) {
    [p.columns, p.ghost] = rows.map((steps) =>
      p.strip.lines.map(({ name, scale = 1 }) => {
        const index = page.hello!.scalars.indexOf(name);
        return steps.map((row) => (row && Number.isFinite(row[index]) ? row[index] * scale : null));
      }),
    );
    p.chart.box.hidden = !p.columns.flat().some((v) => v !== null);
  }
}

/** Draws at most ten times a second, and less often where it takes long: at most a sixth of the time. */
function draw(now = false) {
  const time = performance.now();
  if (!now && time - drawn < Math.max(100, 6 * took)) return;
  if (page.shown !== "charts" || !isVisible || !page.hello || !page.frame) return;
  drawn = time;
  collect();
  plotted.forEach(drawStrip);
  drawCovariance(page.frame.covariance);
  drawHistogram();
  showCursor(page.cursor);
  took = performance.now() - time;
}
on("drawn", () => draw());
on("shown", (pane) => pane === "charts" && draw(true));
on("theme", () => draw(true));
let isVisible = false;
new ResizeObserver(([{ contentRect }]) => {
  isVisible = contentRect.width > 0;
  draw(true);
}).observe(root);

function drawStrip({ strip, chart, columns, ghost }: Plotted) {
  const lines = strip.lines.map(({ colour, dash, right }, i) => {
    return { width: 1.6, stroke: css(colour), dash, scale: right ? "r" : "y", show: chart.shown[i] };
  });
  const isTwofold = strip.lines.some((line) => line.right);
  const isLogarithmic = isLog && strip.title.startsWith("Cost");
  const options: Partial<uPlot.Options> = {
    height: 104,
    cursor: { show: true, y: false, drag: { x: true, y: false, setScale: false }, points: { size: 7 } },
    scales: {
      x: { time: false, range },
      y: isLogarithmic ? { distr: 4, asinh: 0.1 } : { range: padded },
      r: { range: padded },
    },
    axes: isTwofold ? [axis({ side: 1, scale: "r", grid: { show: false } })] : [],
    series: [...lines, ...lines.map((each) => ({ ...each, width: 1, alpha: 0.45 }))],
    hooks: { ready: [watch], draw: [markShown], setSelect: [zoomToSelected] },
  };
  const data = [times, ...columns, ...ghost] as uPlot.AlignedData;
  chart.draw("s", data, options, isLogarithmic ? "log" : "");
}

function drawCovariance(variances: Float32Array | undefined) {
  covariance.box.hidden = !variances?.length;
  if (!variances?.length) return;
  const step = scalar("prediction_step");
  const x = Array.from({ length: variances.length + 1 }, (_, i) => +(i * step).toFixed(4));
  const y = Array.from(variances, Math.sqrt);
  const blue = css("--blue");
  const paths = uPlot.paths.stepped!({ align: 1 });
  covariance.draw("s", [x, [...y, y[y.length - 1]]], {
    scales: { y: { range: fromZero(1e-3) } },
    series: [{ stroke: blue, fill: blue + "33", width: 1.6, paths }],
  });
}

/** Shows the values at the cursor, else at the tick that is shown. */
function showValues() {
  const i = ticks.indexOf(page.cursor ?? scalar("tick"));
  const samples = scalar("samples");
  for (const { strip, chart, columns } of plotted)
    for (const [k, line] of strip.lines.entries()) {
      const v = i < 0 ? null : columns[k][i];
      const of = line.name === "effective_samples" && samples > 0 ? ` of ${samples}` : "";
      say(chart.values[k], `${line.label} ${v == null ? "–" : v.toFixed(line.digits ?? 2)}${of}`);
    }
}

function drawHistogram() {
  const values: number[] = [];
  for (let i = past.newest; i >= past.oldest && values.length < most; --i) {
    const row = past.at(i);
    if (row && Number.isFinite(scalar("tick_ms", row))) values.push(scalar("tick_ms", row));
  }
  histogram.box.hidden = !values.length;
  if (!values.length) return;
  values.sort((a, b) => a - b);
  const quantile = (p: number) => values[Math.floor(p * (values.length - 1))];
  const deadline = () => scalar("deadline_ms");
  const top = Math.max(2, quantile(0.995) * 1.3);
  histogram.histogram("ms", values, 0, top, { draw: [(u) => vertical(u, deadline(), "--bad", [5, 4])] });
  const parts = [`median ${quantile(0.5).toFixed(2)}`, `p99 ${quantile(0.99).toFixed(2)}`];
  const missed = values.filter((v) => v > deadline()).length;
  parts.push(`deadline ${deadline().toFixed(0)}`, `missed ${missed}`);
  histogram.values[0].textContent = parts.join(" · ");
}

/** The values of the charts as comma-separated values, with the names of the scalars. */
function csv(): string {
  if (page.hello) collect();
  const shown = plotted.filter((p) => !p.chart.box.hidden);
  const columns = shown.flatMap((p) =>
    p.strip.lines.flatMap((line, i) => {
      const unit = unitOf(p.strip, line);
      const ghost = { name: "ghost_" + line.name, unit, values: p.ghost[i] };
      const hasGhost = ghost.values.some((v) => v !== null);
      return [{ name: line.name, unit, values: p.columns[i] }, ...(hasGhost ? [ghost] : [])];
    }),
  );
  const rows = ticks.map((tick, i) => [tick, times[i], ...columns.map(({ values }) => values[i] ?? "")]);
  const head = ["tick", "time [s]", ...columns.map(({ name, unit }) => name + (unit && ` [${unit}]`))];
  return [head, ...rows].map((row) => row.join()).join("\n") + "\n";
}
