import type { BestLap } from "./best_lap";
import { get } from "./dom";
import { page, scalar } from "./page";

const fewSamples = 3; // limit of SolveResult::has_few_samples
const fewFrames = 20; // in a row with few samples, before it is said

function signed(value: number, digits: number) {
  const amount = Math.abs(value).toFixed(digits);
  return (value >= 0 || Number(amount) === 0 ? "+" : "−") + amount;
}

/** Sets the value of a figure, which stands before its unit. */
function figure(
  id: string,
  value: number,
  digits: number,
  text = Number.isFinite(value) ? value.toFixed(digits) : "–",
) {
  get(id).firstChild!.textContent = text;
}

/** The figures over the scene, and the labels of car and ghost. */
export class Readout {
  private frames = 0; // with few samples, in a row

  show(best: BestLap) {
    figure("speed", scalar("speed"), 1);
    figure("lap-time", scalar("lap_time"), 1);
    figure("clearance", scalar("clearance"), 2);
    figure("solve", scalar("tick_ms"), 2);
    figure("contacts", scalar("contacts"), 0);
    get("lap-number").textContent = `lap ${scalar("lap") + 1}`;
    get("solve").hidden = get("solve-label").hidden = !Number.isFinite(scalar("tick_ms"));
    this.label();
    const behind = best.behind(scalar("progress"), scalar("lap_time"));
    get("best").hidden = get("best-label").hidden = behind === undefined;
    get("best-label").textContent = `to best lap (${best.number})`;
    if (behind !== undefined) figure("best", behind, 2, signed(behind, 2));
    const ghost = page.frame?.ghost;
    get("gap").hidden = get("gap-label").hidden = !ghost;
    if (!ghost || !page.state) return;
    const ahead = (scalar("lap") + scalar("progress") - ghost.laps) * page.state.length;
    figure("gap", ahead, 1, signed(ahead, 1));
    get("ghost-label").textContent = "ghost · " + (page.state.ghost_label || page.state.ghost);
  }

  private label() {
    const { statuses, methods } = page.hello!;
    const label = get("label");
    const status = statuses[scalar("status")] ?? "";
    this.frames = scalar("effective_samples") < fewSamples ? this.frames + 1 : 0;
    const isFew = this.frames >= fewFrames;
    const parts = [methods[scalar("method")] ?? ""];
    if (status && status !== "ok") parts.push(status.replace(/_/g, " "));
    if (isFew) parts.push("few samples");
    const advice = "raise the temperature or reduce the variances";
    label.textContent = parts.join(" · ");
    label.title = isFew ? `The effective sample size stays below ${fewSamples}: ${advice}.` : "";
    label.classList.toggle("blocked", status === "blocked");
  }
}
