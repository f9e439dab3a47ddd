import { make } from "./dom";
import { drivenOf, methodOf, page, scalar } from "./page";
import type { Body, Frame } from "./protocol";

/** On which side of an obstacle something passes: left, right, or into it. */
type Side = "left" | "right" | "into";

/** Facts about how a controller passes the next obstacle, from its frame alone. */
interface Ways {
  verdict: "averages" | "commits" | "hits" | "";
  plan: Side;
  percent: Record<Side, number>; // shares of the weight of the samples that come to the obstacle; 100 in all
}

interface Point {
  x: number;
  y: number;
}

/** Half the longest extent of a body, m. */
const diagonal = ({ kind, length, width }: Body) => (kind >= 3 ? length : Math.hypot(length, width)) / 2;

/** The offset to the left (m) at which a trajectory passes an obstacle, or ends beside it; undefined if before. */
function offset(trajectory: Point[], from: Body, place: Body): number | undefined {
  const yaw = Math.atan2(place.y - from.y, place.x - from.x);
  const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
  const ahead = (p: Point) => c * (p.x - place.x) + s * (p.y - place.y);
  const left = (p: Point) => c * (p.y - place.y) - s * (p.x - place.x);
  const i = trajectory.findIndex((p, k) => k > 0 && ahead(p) >= 0);
  const last = trajectory.at(-1)!;
  if (i < 0) return ahead(last) > -diagonal(place) - diagonal(from) ? left(last) : undefined;
  const [a, b] = [trajectory[i - 1], trajectory[i]];
  const share = ahead(b) > ahead(a) ? -ahead(a) / (ahead(b) - ahead(a)) : 0;
  return left(a) + share * (left(b) - left(a));
}

const distance = (p: Point, q: Point) => Math.hypot(p.x - q.x, p.y - q.y);
/** Half the width of a body (m) as it is seen from somewhere. */
function halfWidth({ kind, length, width, yaw, ...at }: Body, from: Point) {
  if (kind >= 3) return length / 2; // a disc
  const turn = yaw - Math.atan2(at.y - from.y, at.x - from.x);
  return (length * Math.abs(Math.sin(turn)) + width * Math.abs(Math.cos(turn))) / 2;
}

/** The obstacles that the plan comes near to, the nearest first, each with its place beside the plan. */
function inTheWay(from: Body, { bodies, plan = [], scalars }: Frame) {
  const end = plan.at(-1) ?? from;
  const isAhead = (b: Body) => (end.x - from.x) * (b.x - from.x) + (end.y - from.y) * (b.y - from.y) > 0;
  const isNear = (b: Body) =>
    plan.some((p) => distance(p, b) < 1.5 * from.length + Math.max(b.length, b.width));
  const hit = plan[scalar("plan_collides_at", scalars)]; // by the problem itself, which may add a margin
  return bodies
    .filter((b) => ![0, 4, 6].includes(b.kind) && isAhead(b) && isNear(b))
    .sort((a, b) => distance(a, from) - distance(b, from))
    .flatMap((obstacle) => {
      const at = offset(plan, from, obstacle);
      if (at === undefined) return [];
      const isPassed = distance(from, end) > distance(from, obstacle); // else it ends before
      // A car knows only what its scanner sees; other problems know themselves.
      const isWithin = Math.abs(at) < halfWidth(obstacle, from) + from.width / 2;
      const isIn = page.hello!.lidar && isPassed && isWithin;
      const isHit = hit && distance(hit, obstacle) < diagonal(obstacle) + 1.2 * diagonal(from);
      return { obstacle, at, isIn: isIn || isHit };
    });
}

const both = 10; // % of the weight on the lighter side from which on both ways count
const one = 90; // % from which on one way is chosen

/**
 * Judges the controller of a frame; undefined if nothing is in its way. `averages`: samples of both ways have
 * weight, and the plan between them leads into the obstacle. `commits`: the plan and nearly all of the weight are
 * on one side. `hits`: the body is in contact, or the plan leads into the obstacle though no two ways have weight.
 */
export function waysOf(frame: Frame): Ways | undefined {
  const { candidates } = frame;
  const from = drivenOf(frame);
  if (!from) return undefined;
  const isHit = scalar("contact", frame.scalars) > 0;
  if (isHit) return { verdict: "hits", plan: "into", percent: { left: 0, right: 0, into: 100 } };
  const all = inTheWay(from, frame);
  const next = all.find(({ isIn }) => isIn) ?? all[0];
  if (!next || !candidates) return undefined;
  const { obstacle } = next;
  const side = (at: number, isIn?: boolean): Side => (isIn ? "into" : at > 0 ? "left" : "right");
  const weights = { left: 0, right: 0, into: 0 };
  const { count, points, xy, terms, width, collided } = candidates;
  for (let k = 0; k < count; ++k) {
    const place = (i: number) => ({ x: xy[2 * (k * points + i)], y: xy[2 * (k * points + i) + 1] });
    const at = offset(
      Array.from({ length: points }, (_, i) => place(i)),
      from,
      obstacle,
    );
    if (at !== undefined) weights[side(at, collided[k] > 0)] += terms[width * (k + 1) - 1];
  }
  const sum = weights.left + weights.right + weights.into;
  if (!sum) return undefined;
  const left = Math.round((100 * weights.left) / sum);
  const right = Math.round((100 * (weights.left + weights.right)) / sum) - left;
  const percent = { left, right, into: 100 - left - right };
  const way = side(next.at, next.isIn);
  if (way !== "into") return { verdict: percent[way] >= one ? "commits" : "", plan: way, percent };
  return { verdict: Math.min(left, right) >= both ? "averages" : "hits", plan: way, percent };
}

/** Shows what a frame says about the next obstacle: its verdict and the shares of the weight. */
export function showWays(line: HTMLElement, frame: Frame | undefined) {
  const ways = frame && waysOf(frame);
  line.hidden = !ways;
  line.dataset.verdict = ways?.verdict ?? "";
  if (!ways) return;
  const { verdict, plan, percent } = ways;
  const isHit = scalar("contact", frame.scalars) > 0;
  const ends = { left: "left", right: "right", into: "into it" };
  const shares = (Object.keys(ends) as Side[]).filter((way) => percent[way] > 0);
  const parts = shares.map((way, i) => `${percent[way]}\u00a0% ${i ? "" : "of the weight "}${ends[way]}`);
  const outcomes = {
    averages: "the plan between them leads into the obstacle",
    hits: "the plan leads into the obstacle",
    commits: `the plan passes ${plan}`,
    "": "more than one way has weight",
  };
  const name = make("b", {}, `${methodOf(frame)} ${verdict || `passes ${plan}`}:`);
  const outcome = make("span", { className: "long" }, `; ${outcomes[verdict]}`);
  line.replaceChildren(name, isHit ? " it is in contact" : ` ${parts.join(", ")}`, isHit ? "" : outcome, ".");
}
