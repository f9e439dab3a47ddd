import type { BestLap } from "./best_lap";
import type { Frame, Hello, State } from "./protocol";

/** The limits of SolveResult::has_few_samples, and how many frames in a row are below the first before it is said. */
const fewSamples = 3, fewFrames = 20;

function signed(value: number, digits: number) {
  const amount = Math.abs(value).toFixed(digits);
  return (value >= 0 || Number(amount) === 0 ? "+" : "−") + amount;
}

/** The figures over the scene, and the label of the car. */
export class Readout {
  private frames = 0; // with few samples, in a row

  show(frame: Frame, hello: Hello, state: State | undefined, best: BestLap) {
    const get = (id: string) => document.getElementById(id)!, scalar = (name: string) => frame.scalars[hello.scalars.indexOf(name)];
    const n = (name: string, digits: number) => { const v = scalar(name); return Number.isFinite(v) ? v.toFixed(digits) : "–"; };
    get("speed").firstChild!.textContent = n("speed", 1);
    get("lap-time").firstChild!.textContent = n("lap_time", 1);
    get("lap-number").textContent = `lap ${scalar("lap") + 1}`;
    get("clearance").firstChild!.textContent = n("clearance", 2);
    get("solve").firstChild!.textContent = n("tick_ms", 2);
    get("solve").hidden = get("solve-label").hidden = !Number.isFinite(scalar("tick_ms"));
    get("contacts").textContent = n("contacts", 0);
    this.label(get("label"), hello, scalar);
    const behind = best.behind(scalar("progress"), scalar("lap_time"));
    get("best").hidden = get("best-label").hidden = behind === undefined;
    get("best-label").textContent = `to best lap (${best.number})`;
    if (behind !== undefined) get("best").firstChild!.textContent = signed(behind, 2);
    const ghost = frame.ghost;
    get("gap").hidden = get("gap-label").hidden = !ghost;
    if (!ghost || !state) return;
    const ahead = (scalar("lap") + scalar("progress") - ghost.laps) * state.length;
    get("gap").firstChild!.textContent = signed(ahead, 1);
    get("ghost-label").textContent = "ghost · " + (state.ghost_label || state.ghost);
  }

  private label(label: HTMLElement, hello: Hello, scalar: (name: string) => number) {
    const status = hello.statuses[scalar("status")] ?? "";
    this.frames = scalar("effective_samples") < fewSamples ? this.frames + 1 : 0;
    const few = this.frames >= fewFrames;
    label.textContent = `${hello.methods[scalar("method")] ?? ""}${status && status !== "ok" ? " · " + status.replace(/_/g, " ") : ""}${few ? " · few samples" : ""}`;
    label.title = few ? `The effective sample size stays below ${fewSamples}: raise the temperature or reduce the variances.` : "";
    label.classList.toggle("blocked", status === "blocked");
  }
}
