import { send } from "./connection";
import { all, click, get, make } from "./dom";
import { can, isMonitor, isReplay, on } from "./page";
import type { State } from "./protocol";
import { toast } from "./toast";

click("take-over", () => send({ do: "take_over" }));

on("connection", ({ isOpen, attempts }) => {
  get("lost").hidden = isOpen || attempts === 0;
  const what = `Reconnecting … (attempt ${attempts}).`;
  get("lost-text").textContent = `${what} The drive continues without this page.`;
  get("connection").className = "pill" + (isOpen ? "" : " bad");
  get("connection-text").textContent = isOpen ? "connected" : "connection lost";
});

on("role", ({ drives }) => {
  get("take-over").hidden = drives;
  for (const id of ["primary", "scenario-menu", "options", "bar"]) get(id).inert = !drives;
});

on("error", ({ message }) => toast(message, true));

// Controls of what a drive cannot do are hidden.
on("hello", () => {
  for (const each of all("[data-can]")) each.hidden = !can(each.dataset.can!);
});

/** Returns the name of the way in which the time of a drive passes, and its meaning. */
function modeOf(state: State): [name: string, meaning: string] {
  if (isReplay) return ["replay", "A recording of an earlier drive"];
  if (isMonitor())
    return ["watching", "This page shows a controller that runs elsewhere, and cannot change it"];
  if (state.real_time)
    return ["real time", "Commands take effect after the wall-clock time of the planner, as on a car"];
  const why = "the same seed gives the same drive on any machine";
  return ["lockstep", `Simulated time waits for the planner: ${why}`];
}

function progressOf(state: State): string {
  if (state.paused) return state.tick < state.newest && !isReplay ? " · earlier tick" : " · paused";
  const rate = state.rate === 0 ? "max speed" : `${state.rate}×`;
  const pace = `${state.pace.toPrecision(2)}×`;
  if (state.rate === 0) return ` · ${rate}` + (state.pace > 0 ? `, ${pace}` : "");
  if (state.pace > 0 && state.pace < 0.95 * state.rate) return ` · ${pace} of ${rate}`;
  return state.rate === 1 ? "" : ` · ${rate}`;
}

// Shows whether the drive is paused, how time passes, and the laps driven.
on("state", (state) => {
  const [mode, meaning] = modeOf(state);
  get("mode").className = "pill" + (state.paused ? " warn" : "");
  get("mode").title = meaning;
  get("mode-text").textContent = mode + progressOf(state);
  get("tab-laps").hidden = !state.length;
  get("laps").hidden = !state.laps.length;
  get("no-laps").hidden = state.laps.length > 0;
  get("lap-rows").replaceChildren(...lapRows(state));
  const rules =
    state.evaluation === "published" ? "evaluation of the published program" : "physical evaluation";
  const edited = state.edited ? ", edited" : "";
  const description = state.description.replace(/([^.])$/, "$1."); // a sentence of course.yaml
  get("about").textContent = `${description} ${state.length.toFixed(1)} m, ${rules}${edited}.`;
});

/** The rows of a table of the laps, the newest first. */
function lapRows(state: State): HTMLElement[] {
  const best = Math.min(...state.laps.map((lap) => lap.time));
  return [...state.laps].reverse().map(({ lap, method, ghost, time, contacts }) => {
    const number = (text: string) => make("td", { className: "n" }, text);
    const cells = [make("td", {}, String(lap)), make("td", {}, method + (ghost ? " (ghost)" : ""))];
    cells.push(number(time.toFixed(2)), number(String(contacts)));
    return make("tr", { className: time === best ? "best" : "" }, ...cells);
  });
}
