import { html, type Markup } from "./html";
import { icon } from "./layout";
import type { State } from "./protocol";

const get = (id: string) => document.getElementById(id)!;

/** Whether the drive is paused, how time passes, and the laps driven. */
export function showStatus(state: State, isReplay: boolean) {
  get("play").innerHTML = state.paused ? `${icon("play")}<span>Play</span>` : `${icon("pause")}<span>Pause</span>`;
  get("play").classList.toggle("primary", state.paused);
  const mode = get("mode"), isEarlier = state.tick < state.newest && !isReplay;
  const progress = state.paused ? (isEarlier ? " · earlier tick" : " · paused") : state.rate === 0 ? " · max speed" : state.rate !== 1 ? ` · ${state.rate}×` : "";
  mode.className = "pill" + (state.paused ? " warn" : "");
  get("mode-text").textContent = (isReplay ? "replay" : state.real_time ? "real time" : "lockstep") + progress;
  mode.title = isReplay ? "A recording of an earlier drive" : state.real_time ? "Commands take effect after the wall-clock time that the planner needed, as on a car" : "Simulated time waits for the planner: the same seed gives the same drive on any machine";
  get("laps").innerHTML = laps(state).text;
  get("about").textContent = `${state.description} ${state.length.toFixed(1)} m, ${state.evaluation === "published" ? "evaluation of the published program" : "physical evaluation"}${state.edited ? ", edited" : ""}.`;
  get("caption").textContent = isReplay ? `${state.course} · ${state.method} · seed ${state.seed} · ${state.obstacles} obstacles${state.opponents ? ` · ${state.opponents} opponents` : ""}` : "";
}

function laps(state: State): Markup {
  if (!state.laps.length) return html`<p>No lap has been completed.</p>`;
  const best = Math.min(...state.laps.map((lap) => lap.time));
  const rows = [...state.laps].reverse().map((lap) => html`<tr class="${lap.time === best ? "best" : ""}"><td>${lap.lap}</td><td>${lap.method}${lap.ghost ? " (ghost)" : ""}</td><td class="n">${Number(lap.time).toFixed(2)}</td><td class="n">${lap.contacts}</td></tr>`);
  return html`<table><thead><tr><th>Lap</th><th>Method</th><th class="n">Time, s</th><th class="n">Collisions</th></tr></thead><tbody>${rows}</tbody></table>`;
}
