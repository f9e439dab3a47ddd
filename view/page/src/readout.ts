import type { BestLap } from "./best_lap";
import { get } from "./dom";
import { page, scalar } from "./page";

function signed(value: number, digits: number) {
  const amount = Math.abs(value).toFixed(digits);
  return (value >= 0 || Number(amount) === 0 ? "+" : "−") + amount;
}

const fixed = (value: number, digits: number) => (Number.isFinite(value) ? value.toFixed(digits) : "–");

const words = (name: string) => name.replace(/_/g, " ");

/** Sets the value of a figure, which stands before its unit. */
const figure = (id: string, text: string) => (get(id).firstChild!.textContent = text);

/** The figures over the scene, and the labels of car and ghost. */
export class Readout {
  show(best: BestLap) {
    figure("speed", fixed(scalar("speed"), 1));
    figure("lap-time", fixed(scalar("lap_time"), 1));
    figure("clearance", fixed(scalar("clearance"), 2));
    figure("solve", fixed(scalar("tick_ms"), 2));
    figure("cost", fixed(scalar("plan_cost"), Math.abs(scalar("plan_cost")) < 100 ? 2 : 0));
    figure("contacts", fixed(scalar("contacts"), 0));
    get("lap-number").textContent = `lap ${scalar("lap") + 1}`;
    get("solve").hidden = get("solve-label").hidden = !Number.isFinite(scalar("tick_ms"));
    this.label();
    const behind = best.behind(scalar("progress"), scalar("lap_time"));
    get("best").hidden = get("best-label").hidden = behind === undefined;
    get("best-label").textContent = `to best lap (${best.number})`;
    if (behind !== undefined) figure("best", signed(behind, 2));
    const ghost = page.frame?.ghost;
    get("gap").hidden = get("gap-label").hidden = !ghost;
    if (!ghost || !page.state) return;
    const ahead = (scalar("lap") + scalar("progress") - ghost.laps) * page.state.length;
    figure("gap", signed(ahead, 1));
    get("ghost-label").textContent = "ghost · " + (page.state.ghost_label || page.state.ghost);
  }

  private label() {
    const { statuses, symptoms, methods } = page.hello!;
    const label = get("label");
    const status = statuses[scalar("status")] ?? "";
    const symptom = symptoms?.[scalar("symptom")];
    // A car that drives steadily has the sign of "no_progress".
    const isShown = !!symptom?.explanation && symptom.name !== "no_progress";
    const parts = [methods[scalar("method")] ?? ""];
    if (status && status !== "ok") parts.push(words(status));
    if (isShown) parts.push(words(symptom.name));
    label.textContent = parts.join(" · ");
    label.title = isShown ? symptom.explanation : "";
    label.classList.toggle("blocked", status === "blocked");
  }
}
