import { send } from "./connection";
import { isReplay, on, page, scalar, tell } from "./page";
import type { Pose } from "./protocol";

/**
 * The scalars of the control steps of the last minute, by their ticks. Some arrive late, since the page was too
 * slow for their frames or opened later.
 */
class Past {
  private rows: (Float64Array | undefined)[] = [];
  oldest = 0; // tick of the first row
  /** The number of steps that are kept. */
  most = Infinity;

  get newest() {
    return this.oldest + this.rows.length - 1;
  }
  at(tick: number): Float64Array | undefined {
    return this.rows[tick - this.oldest];
  }

  set(tick: number, scalars: Float64Array) {
    if (!this.rows.length || tick > this.newest + this.most) {
      this.rows = [];
      this.oldest = tick;
    }
    if (tick < this.oldest) {
      if (this.newest - tick >= this.most) return;
      this.rows = [...new Array<undefined>(this.oldest - tick), ...this.rows];
      this.oldest = tick;
    }
    while (this.newest < tick) this.rows.push(undefined);
    this.rows[tick - this.oldest] = scalars;
    const surplus = this.rows.length - this.most;
    if (surplus > 0) {
      this.rows.splice(0, surplus);
      this.oldest += surplus;
    }
  }

  /** The pose of the driven body. */
  pose(tick: number): Pose | undefined {
    const row = this.at(tick);
    return row && { x: scalar("x", row), y: scalar("y", row), yaw: scalar("yaw", row) };
  }

  /** Forgets the steps after a tick: the drive went back and continues from there. */
  forgetAfter(tick: number) {
    this.rows.length = Math.max(0, Math.min(this.rows.length, tick - this.oldest + 1));
  }

  /** The line that was driven until the step that is shown, as x and y (m) one after the other. */
  line(): number[] {
    const line: number[] = [];
    const [x0, y0, x1, y1] = page.state?.bounds ?? [0, 0, 8, 8];
    const longest = Math.max(x1 - x0, y1 - y0) / 4; // m that a step can be
    for (const row of this.rows.slice(0, Math.max(0, scalar("tick") - this.oldest + 1))) {
      if (!row) continue;
      const [x, y] = [scalar("x", row), scalar("y", row)];
      const [dx, dy] = [x - line[line.length - 2], y - line[line.length - 1]];
      if (Math.hypot(dx, dy) > longest) line.length = 0; // it was put elsewhere
      line.push(x, y);
    }
    return line;
  }

  /** The newest steps between two ticks of which some are not known; at most `most`. */
  missing(oldest: number, newest: number, most: number): { from: number; to: number } | undefined {
    let to = newest;
    while (to >= oldest && this.at(to)) --to;
    if (to < oldest) return undefined;
    let from = Math.max(oldest, to - most + 1);
    while (from < to && this.at(from)) ++from;
    return { from, to };
  }
}

export const past = new Past();
export const ghostPast = new Past();

let generation = 0; // number of the drive
function forget() {
  for (const each of [past, ghostPast]) each.forgetAfter(-Infinity);
  tell("forgotten", true);
}
on("connection", ({ isOpen }) => isOpen && forget());
on("scene", forget);
on("hello", ({ history_seconds, control_period }) => {
  if (!isReplay) past.most = ghostPast.most = Math.ceil(history_seconds / control_period);
});
on("state", (state) => {
  if (state.generation !== generation) forget();
  generation = state.generation;
  if (state.paused) past.forgetAfter(state.newest);
});
on("frame", ({ scalars, ghostFrame }) => {
  const tick = scalar("tick");
  if (!isReplay && !page.state?.paused) for (const each of [past, ghostPast]) each.forgetAfter(tick);
  past.set(tick, scalars);
  if (ghostFrame) ghostPast.set(tick, ghostFrame.scalars);
});
on("past", (scalars) => {
  isAsking = false;
  const width = page.hello?.scalars.length ?? 0;
  for (let i = 0; width && i < scalars.length; i += width) {
    const row = scalars.slice(i, i + width);
    past.set(scalar("tick", row), row);
  }
});

const pause = 400; // ms between two questions
const patience = 4000; // ms until an answer that did not come is asked for again
const many = 800; // steps in one answer
let isAsking = false;
let askedAt = -Infinity;

/** Asks for the scalars of steps whose frames did not come. */
on("drawn", () => {
  const { state } = page;
  const now = performance.now();
  if (!state || now - askedAt < (isAsking ? patience : pause)) return;
  const gap = past.missing(Math.max(0, state.oldest), Math.max(state.newest, past.newest), many);
  if (!gap) return;
  isAsking = true;
  askedAt = now;
  send({ do: "past", ...gap });
});
