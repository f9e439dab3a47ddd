import { all, get, say } from "./dom";
import { methodOf, on, page, scalar } from "./page";
import type { Hello } from "./protocol";

// The figures over the scene, and the labels of the driven body and of the ghost.

function signed(value: number, digits: number) {
  const amount = Math.abs(value).toFixed(digits);
  return (value >= 0 || Number(amount) === 0 ? "+" : "−") + amount;
}
/** Meanings of the statuses with which a body does not just drive on. */
const reasons: Record<string, string> = {
  all_collided: "Every sample collides.",
  detour: "The path is blocked; this is the way around.",
  braking: "The plan soon meets an obstacle, so the robot brakes.",
  blocked: "Every plan collides, so it stands.",
  goal_occupied: "Something is on the goal, so the robot stands before it.",
  stuck: "It got no further, so it stands for a while and tries again.",
  waiting: "It waits for somebody who moves, or for another way.",
  commands_ignored: "The robot does not move although it is told to.",
  goal_reached: "It stands at the goal.",
  no_path: "There is no path, or the robot is off its map.",
  fallback_plan: "The solution collides, so another plan is driven.",
  off_course: "The car is too far from its line, so it brakes.",
};
const words = (name: string) => name.replace(/_/g, " ");

/** Shows a figure before its unit, with its name; hides both where there is none. */
function show(value: HTMLElement, text: string | undefined) {
  value.hidden = (value.previousElementSibling as HTMLElement).hidden = text === undefined;
  say(value.firstChild!, text ?? "");
}

function showFigures() {
  for (const each of all("[data-scalar]")) {
    const value = scalar(each.dataset.scalar!);
    show(each, Number.isFinite(value) ? value.toFixed(Number(each.dataset.digits)) : undefined);
  }
  say(get("lap-number"), `lap ${scalar("lap") + 1}`);
  const ghost = page.frame?.ghostFrame?.scalars;
  const driven = (of?: Float64Array) => scalar("lap", of) + scalar("progress", of); // laps
  const ahead = ghost && page.state ? (driven() - driven(ghost)) * page.state.length : NaN;
  show(get("gap"), Number.isFinite(ahead) ? signed(ahead, 1) : undefined);
}

function showLabels({ statuses, symptoms }: Hello) {
  const label = get("label");
  const status = statuses[scalar("status")] ?? "";
  const symptom = symptoms[scalar("symptom")];
  // A car that drives steadily has the sign of "no_progress".
  const isShown = !!symptom?.explanation && symptom.name !== "no_progress";
  const parts = [methodOf(page.frame)];
  if (status && status !== "ok") parts.push(words(status));
  if (isShown) parts.push(words(symptom.name));
  say(label, parts.join(" · "));
  label.title = [reasons[status], isShown && symptom.explanation].filter(Boolean).join(" ");
  get("why").hidden = !label.title;
  say(get("why"), label.title);
  label.classList.toggle("blocked", status === "blocked");
  const { ghost_label, ghost } = page.state ?? {};
  say(get("ghost-label"), `ghost · ${ghost_label || ghost}`);
}

for (const what of ["frame", "state", "past"] as const)
  on(what, () => {
    if (!page.hello || !page.frame) return;
    get("readout").hidden = false;
    showFigures();
    showLabels(page.hello);
  });
