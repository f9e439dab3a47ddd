import { get } from "./dom";
import type { State } from "./protocol";

interface Setting {
  send(command: Record<string, unknown>): void;
  state(): State | undefined;
  /** The tick that the page shows, if it shows any. */
  shown(): number | undefined;
  /** Opens the dialog of a fork, in a drive that is paused. */
  fork(): void;
}

/** The controls of the drive: time, nudges and forks. Returns their keys. */
export function attachDrive({ send, state, shown, fork }: Setting): Record<string, () => void> {
  const nudge = (left: number) => () => send({ do: "nudge", left });
  const step = () => send({ do: "step" });
  const restart = () => send({ do: "restart" });
  const back = () => {
    const now = state();
    if (now) send({ do: "seek", tick: (now.paused ? now.tick : now.newest) - 1 });
  };
  const play = () => {
    // A slow browser shows an earlier tick than the server has reached; it pauses at the tick shown.
    if (state()?.paused) send({ do: "play" });
    else send({ do: "pause", tick: shown() });
  };
  const openFork = () => {
    if (!state()?.paused) send({ do: "pause" });
    fork();
  };
  const buttons = {
    play,
    step,
    restart,
    fork: openFork,
    "nudge-left": nudge(0.15),
    "nudge-right": nudge(-0.15),
  };
  for (const [id, act] of Object.entries(buttons)) get(id).onclick = act;
  return {
    " ": play,
    ".": step,
    ",": back,
    "[": buttons["nudge-left"],
    "]": buttons["nudge-right"],
    r: restart,
    k: openFork,
  };
}
