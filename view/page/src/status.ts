import { get, html, type Markup } from "./dom";
import { icon } from "./layout";
import { isReplay } from "./page";
import type { State } from "./protocol";

/** Shows whether there is a server, and for how many attempts there has been none. */
export function showConnection(connected: boolean, attempts: number) {
  get("lost").hidden = connected || attempts === 0;
  const what = `Reconnecting … (attempt ${attempts}).`;
  get("lost-text").textContent = `${what} The drive continues without this page.`;
  get("connection").className = "pill" + (connected ? "" : " bad");
  get("connection-text").textContent = connected ? "connected" : "connection lost";
}

/** Shows whether this page drives, or watches and can take over. */
export function showRole(drives: boolean) {
  get("take-over").hidden = drives;
  for (const id of ["primary", "scenario-menu", "options", "bar"]) get(id).inert = !drives;
}

/** How the time of a drive passes: its name and what it means. */
function modeOf(state: State): [name: string, meaning: string] {
  if (isReplay) return ["replay", "A recording of an earlier drive"];
  if (state.real_time)
    return ["real time", "Commands take effect after the wall-clock time of the planner, as on a car"];
  const why = "the same seed gives the same drive on any machine";
  return ["lockstep", `Simulated time waits for the planner: ${why}`];
}

function progressOf(state: State): string {
  if (state.paused) return state.tick < state.newest && !isReplay ? " · earlier tick" : " · paused";
  return state.rate === 0 ? " · max speed" : state.rate !== 1 ? ` · ${state.rate}×` : "";
}

/** Shows whether the drive is paused, how time passes, and the laps driven. */
export function showStatus(state: State) {
  get("play").innerHTML =
    `${icon(state.paused ? "play" : "pause")}<span>${state.paused ? "Play" : "Pause"}</span>`;
  get("play").classList.toggle("primary", state.paused);
  const [mode, meaning] = modeOf(state);
  get("mode").className = "pill" + (state.paused ? " warn" : "");
  get("mode").title = meaning;
  get("mode-text").textContent = mode + progressOf(state);
  get("laps").innerHTML = laps(state).text;
  const rules =
    state.evaluation === "published" ? "evaluation of the published program" : "physical evaluation";
  const edited = state.edited ? ", edited" : "";
  get("about").textContent = `${state.description} ${state.length.toFixed(1)} m, ${rules}${edited}.`;
  const parts = [state.course, state.method, `seed ${state.seed}`, `${state.obstacles} obstacles`];
  if (state.opponents) parts.push(`${state.opponents} opponents`);
  get("caption").textContent = isReplay ? parts.join(" · ") : "";
}

function laps(state: State): Markup {
  if (!state.laps.length) return html`<p>No lap has been completed.</p>`;
  const best = Math.min(...state.laps.map((lap) => lap.time));
  const rows = [...state.laps].reverse().map(
    ({ lap, method, ghost, time, contacts }) =>
      html`<tr class="${time === best ? "best" : ""}">
        <td>${lap}</td><td>${method}${ghost ? " (ghost)" : ""}</td>
        <td class="n">${time.toFixed(2)}</td><td class="n">${contacts}</td>
      </tr>`,
  );
  return html`<table>
    <thead><tr><th>Lap</th><th>Method</th><th class="n">Time, s</th><th class="n">Collisions</th></tr></thead>
    <tbody>${rows}</tbody>
  </table>`;
}
