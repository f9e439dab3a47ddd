import { get } from "./dom";
import { page, send } from "./page";
import { showStatus } from "./status";

/** The controls of the drive: time, nudges and forks. `openFork` opens the dialog. Returns what they do. */
export function attachDrive(openFork: () => void) {
  const nudge = (left: number) => () => send({ do: "nudge", left });
  const step = () => send({ do: "step" });
  const restart = () => send({ do: "restart" });
  const back = () => {
    const now = page.state;
    if (now) send({ do: "seek", tick: (now.paused ? now.tick : now.newest) - 1 });
  };
  const play = () => {
    const { state } = page;
    if (!state) return;
    send({ do: state.paused ? "play" : "pause" });
    state.paused = !state.paused; // until the server says so, which may take a moment
    showStatus(state);
  };
  const fork = () => {
    if (!page.state?.paused) send({ do: "pause" });
    openFork();
  };
  const [left, right] = [nudge(0.15), nudge(-0.15)];
  const buttons = { play, step, restart, fork, "nudge-left": left, "nudge-right": right };
  for (const [id, act] of Object.entries(buttons)) get(id).onclick = act;
  return { play, step, back, restart, fork, left, right };
}
