import { get } from "./dom";
import { page, scalar, send } from "./page";

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
    // A slow browser shows an earlier tick than the server has reached; it pauses at the tick shown.
    if (page.state?.paused) send({ do: "play" });
    else send({ do: "pause", tick: page.frame && scalar("tick") });
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
