import type { Past } from "./past";
import { page, scalar } from "./page";
import type { LapRow, Pose } from "./protocol";

/** The control steps of a lap: share of the way round (0 to 1), time since its start (s), and pose. */
interface Driven {
  row: LapRow;
  progress: number[];
  times: number[];
  poses: Pose[];
}

const atEnds = 0.05; // share of the way within which the steps of a whole lap begin and end

const isSame = (a: LapRow, b: LapRow) => a.lap === b.lap && a.time === b.time;

/** The best lap without a collision: a flying one if there is any, since a standing start takes longer. */
function bestOf(laps: LapRow[]): LapRow | undefined {
  const own = laps.filter((lap) => !lap.ghost && lap.contacts === 0);
  const flying = own.filter((lap) => lap.lap > 1);
  return (flying.length ? flying : own).sort((a, b) => a.time - b.time)[0];
}

/** Between two values of rising `keys`: the index before `key` and the share of the way to the next. */
function between(keys: number[], key: number): [number, number] {
  const found = keys.findIndex((each) => each >= key);
  const after = Math.max(1, found < 0 ? keys.length - 1 : found);
  const share = (key - keys[after - 1]) / (keys[after] - keys[after - 1] || 1);
  return [after - 1, Math.min(1, Math.max(0, share))];
}

/** The best lap of the drive, once the page knows all its steps, to compare the car with. */
export class BestLap {
  private lap?: Driven;

  /** The number of the lap that is compared with. */
  get number() {
    return this.lap?.row.lap;
  }
  forget() {
    this.lap = undefined;
  }

  /** To be called when laps or steps may have become known, or unknown since the drive went back. */
  update(past: Past) {
    const { laps } = page.state!;
    if (this.lap && !laps.some((row) => isSame(row, this.lap!.row))) this.lap = undefined;
    const best = bestOf(laps);
    if (best && !(this.lap && isSame(best, this.lap.row))) this.lap = collected(best, past) ?? this.lap;
  }

  /** The time (s) by which a car is behind at this share of the way, `time` after the start of its lap. */
  behind(progress: number, time: number): number | undefined {
    if (!this.lap) return undefined;
    const [i, share] = between(this.lap.progress, progress);
    const { times } = this.lap;
    return time - (times[i] + share * (times[i + 1] - times[i]));
  }

  /** The pose of the best lap at a time (s) after its start. */
  at(time: number): Pose | undefined {
    if (!this.lap) return undefined;
    const [i, share] = between(this.lap.times, time);
    const a = this.lap.poses[i];
    const b = this.lap.poses[i + 1];
    const turn = Math.atan2(Math.sin(b.yaw - a.yaw), Math.cos(b.yaw - a.yaw));
    return { x: a.x + share * (b.x - a.x), y: a.y + share * (b.y - a.y), yaw: a.yaw + share * turn };
  }
}

/** The steps of a lap, or undefined where one of them is not known. */
function collected(row: LapRow, past: Past): Driven | undefined {
  const driven: Driven = { row, progress: [], times: [], poses: [] };
  let isWithin = false;
  for (let position = past.oldest; position <= past.newest; ++position) {
    const step = past.at(position);
    if (!step) {
      if (isWithin) return undefined;
      continue;
    }
    const of = (name: string) => scalar(name, step);
    isWithin = of("lap") === row.lap - 1;
    if (!isWithin && driven.times.length) break;
    // A car that rolls back is at these places again later.
    if (!isWithin || of("progress") <= (driven.progress.at(-1) ?? -Infinity)) continue;
    driven.progress.push(of("progress"));
    driven.times.push(of("lap_time"));
    driven.poses.push({ x: of("x"), y: of("y"), yaw: of("yaw") });
  }
  return driven.times.length > 1 && driven.progress[0] < atEnds && driven.progress.at(-1)! > 1 - atEnds
    ? driven
    : undefined;
}
