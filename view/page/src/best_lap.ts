import { on, page, scalar } from "./page";
import { past } from "./past";
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

/** The steps of a lap, or undefined where one of them is not known. */
function collected(row: LapRow): Driven | undefined {
  const driven: Driven = { row, progress: [], times: [], poses: [] };
  let isWithin = false;
  for (let tick = past.oldest; tick <= past.newest; ++tick) {
    const step = past.at(tick);
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
  const isWhole =
    driven.times.length > 1 && driven.progress[0] < atEnds && driven.progress.at(-1)! > 1 - atEnds;
  return isWhole ? driven : undefined;
}

let lap: Driven | undefined; // the best, once the page knows all its steps
for (const what of ["frame", "state", "past"] as const)
  on(what, () => {
    const laps = page.state?.laps ?? [];
    if (lap && !laps.some((row) => isSame(row, lap!.row))) lap = undefined;
    const best = bestOf(laps);
    if (best && !(lap && isSame(best, lap.row))) lap = collected(best) ?? lap;
  });

/** The number of the best lap. */
export const bestNumber = () => lap?.row.lap;

/** The time (s) by which the car is behind the best lap at the same place. */
export function behindBest(): number | undefined {
  if (!lap) return undefined;
  const [i, share] = between(lap.progress, scalar("progress"));
  return scalar("lap_time") - (lap.times[i] + share * (lap.times[i + 1] - lap.times[i]));
}

/** The pose of the best lap as long after its start as the car is after its own. */
export function bestPose(): Pose | undefined {
  if (!lap) return undefined;
  const [i, share] = between(lap.times, scalar("lap_time"));
  const [a, b] = [lap.poses[i], lap.poses[i + 1]];
  const turn = Math.atan2(Math.sin(b.yaw - a.yaw), Math.cos(b.yaw - a.yaw));
  return { x: a.x + share * (b.x - a.x), y: a.y + share * (b.y - a.y), yaw: a.yaw + share * turn };
}
