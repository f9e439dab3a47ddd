import { page, scalar, send } from "./page";

/**
 * The scalars of the control steps of the last minute, by their position: the tick, or the index of the frame
 * in a recording. Some arrive late, since the page was too slow for their frames or opened later.
 */
export class Past {
  private rows: (Float64Array | undefined)[] = [];
  oldest = 0; // position of the first row

  /** `most`: the number of steps that are kept. */
  constructor(public most: number) {}

  get newest() {
    return this.oldest + this.rows.length - 1;
  }
  at(position: number): Float64Array | undefined {
    return this.rows[position - this.oldest];
  }

  set(position: number, scalars: Float64Array) {
    if (!this.rows.length || position > this.newest + this.most) {
      this.rows = [];
      this.oldest = position;
    }
    if (position < this.oldest) {
      if (this.newest - position >= this.most) return;
      this.rows = [...new Array<undefined>(this.oldest - position), ...this.rows];
      this.oldest = position;
    }
    while (this.newest < position) this.rows.push(undefined);
    this.rows[position - this.oldest] = scalars;
    const surplus = this.rows.length - this.most;
    if (surplus > 0) {
      this.rows.splice(0, surplus);
      this.oldest += surplus;
    }
  }

  /** Forgets the steps after a position: the drive went back and continues from there. */
  forgetAfter(position: number) {
    this.rows.length = Math.max(0, Math.min(this.rows.length, position - this.oldest + 1));
  }
  clear() {
    this.rows = [];
  }

  /** The line that was driven, as x and y (m) one after the other, up to a position. */
  line(position: number): number[] {
    const line: number[] = [];
    const [x0, y0, x1, y1] = page.state?.bounds ?? [0, 0, 8, 8];
    const longest = Math.max(x1 - x0, y1 - y0) / 4; // m that a step can be
    for (const row of this.rows.slice(0, Math.max(0, position - this.oldest + 1))) {
      if (!row) continue;
      const [x, y] = [scalar("x", row), scalar("y", row)];
      const [dx, dy] = [x - line[line.length - 2], y - line[line.length - 1]];
      if (Math.hypot(dx, dy) > longest) line.length = 0; // it was put elsewhere
      line.push(x, y);
    }
    return line;
  }

  /** The newest steps between two positions of which some are not known; at most `most`. */
  missing(oldest: number, newest: number, most: number): { from: number; to: number } | undefined {
    let to = newest;
    while (to >= oldest && this.at(to)) --to;
    if (to < oldest) return undefined;
    let from = Math.max(oldest, to - most + 1);
    while (from < to && this.at(from)) ++from;
    return { from, to };
  }
}

const pause = 400; // ms between two questions
const patience = 4000; // ms until an answer that did not come is asked for again
const many = 800; // steps in one answer

/** Asks the server for the scalars of steps whose frames did not come. */
export class Gaps {
  private isAsking = false;
  private askedAt = -Infinity;

  fill(past: Past) {
    const state = page.state!;
    const now = performance.now();
    if (now - this.askedAt < (this.isAsking ? patience : pause)) return;
    const gap = past.missing(Math.max(0, state.oldest), Math.max(state.newest, past.newest), many);
    if (!gap) return;
    this.isAsking = true;
    this.askedAt = now;
    send({ do: "past", ...gap });
  }

  answered() {
    this.isAsking = false;
  }
}
