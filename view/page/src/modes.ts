import { make } from "./dom";
import { drivenOf, page, scalar } from "./page";
import type { Body, Frame } from "./protocol";

/** On which side of an obstacle something passes: left, right, or into it. */
type Side = "left" | "right" | "into";

/** The side on which a controller passes the next obstacle: that of its plan, and the weight of each side. */
interface Modes {
  plan: Side;
  left: number; // share of the weight, 0 ... 1
  right: number;
}

interface Point {
  x: number;
  y: number;
}
const beside = 1.5; // lengths of the body from an obstacle to a plan that passes it

/** The offset to the left (m) at which a trajectory passes an obstacle; undefined if it ends before. */
function offset(trajectory: Point[], from: Point, obstacle: Point): number | undefined {
  const yaw = Math.atan2(obstacle.y - from.y, obstacle.x - from.x);
  const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
  const ahead = (p: Point) => c * (p.x - obstacle.x) + s * (p.y - obstacle.y);
  const left = (p: Point) => c * (p.y - obstacle.y) - s * (p.x - obstacle.x);
  const i = trajectory.findIndex((p, k) => k > 0 && ahead(p) >= 0);
  if (i < 0) return undefined;
  const [a, b] = [trajectory[i - 1], trajectory[i]];
  const share = ahead(b) > ahead(a) ? -ahead(a) / (ahead(b) - ahead(a)) : 0;
  return left(a) + share * (left(b) - left(a));
}

const distance = (p: Point, q: Point) => Math.hypot(p.x - q.x, p.y - q.y);

/** The nearest obstacle ahead that the plan passes. */
function nextObstacle(from: Body, { bodies, plan = [] }: Frame): Body | undefined {
  const isAhead = ({ x, y }: Point) =>
    Math.cos(from.yaw) * (x - from.x) + Math.sin(from.yaw) * (y - from.y) > 0;
  const isNear = (b: Body) => {
    const reach = beside * from.length + b.length / 2;
    return plan.some((p) => distance(p, b) < reach);
  };
  return bodies
    .filter((b) => ![0, 4, 6].includes(b.kind) && isAhead(b) && isNear(b))
    .sort((a, b) => distance(a, from) - distance(b, from))[0];
}

/** Returns how the controller of a frame passes the next obstacle; undefined if the plan reaches none. */
export function modesOf(frame: Frame): Modes | undefined {
  const { plan, candidates } = frame;
  const from = drivenOf(frame);
  const obstacle = from && nextObstacle(from, frame);
  if (!obstacle || !plan || !candidates) return undefined;
  const size = obstacle.kind === 3 ? obstacle.length : obstacle.width;
  const reach = (size + page.hello!.body.width) / 2;
  const side = (at: number): Side => (Math.abs(at) < reach ? "into" : at > 0 ? "left" : "right");
  const planned = offset(plan, from, obstacle);
  if (planned === undefined) return undefined;
  const weights = { left: 0, right: 0, into: 0 };
  const { count, points, xy, terms, width } = candidates;
  for (let k = 0; k < count; ++k) {
    const pointAt = (_: unknown, i: number) => ({
      x: xy[2 * (k * points + i)],
      y: xy[2 * (k * points + i) + 1],
    });
    const at = offset(Array.from({ length: points }, pointAt), from, obstacle);
    if (at !== undefined) weights[side(at)] += terms[width * (k + 1) - 1];
  }
  const all = weights.left + weights.right + weights.into || 1;
  return { plan: side(planned), left: weights.left / all, right: weights.right / all };
}

/** Says what a method does at the next obstacle: its verdict, the figures, and what follows. */
function sentence(method: string, modes: Modes, what: Verdict): (Node | string)[] {
  const percent = (share: number) => `${Math.round(100 * share)} %`;
  if (what === "averages") {
    const shares = `${percent(modes.left)} of the weight left, ${percent(modes.right)} right.`;
    const outcome = " The plan between them leads into the obstacle.";
    return [make("b", {}, `${method} averages:`), ` ${shares}`, make("span", { className: "long" }, outcome)];
  }
  const share = percent(modes[modes.plan as "left" | "right"]);
  return [make("b", {}, `${method} commits:`), ` the plan and ${share} of the weight pass ${modes.plan}.`];
}

type Verdict = "averages" | "commits";
const both = 0.15; // share of the weight on the lighter side from which on both ways count
const one = 0.9; // share from which on one way is chosen

/**
 * Judges a controller. `averages`: samples of both ways have weight, and the plan between them leads into the
 * obstacle. `commits`: the plan and nearly all of the weight are on one side.
 */
export function verdict(modes: Modes | undefined): Verdict | undefined {
  if (!modes) return undefined;
  if (modes.plan === "into") return Math.min(modes.left, modes.right) >= both ? "averages" : undefined;
  return modes[modes.plan] >= one ? "commits" : undefined;
}

const hold = 0.5; // s of simulated time that a sentence stays, so that it can be read

/**
 * The sentence over a scene. While time passes, another verdict is shown once it has held for two frames; a
 * frame of the same time, planned again for a change, is judged at once.
 */
export class Caption {
  private time = NaN; // s
  private since = 0; // s
  private before?: Verdict; // verdict of the frame before

  constructor(private readonly line: HTMLElement) {}

  /** Shows what a frame says at a time (s); nothing without a frame, and of a car in contact. */
  show(method: string, frame: Frame | undefined, time: number) {
    const modes = frame && !scalar("contact", frame.scalars) ? modesOf(frame) : undefined;
    const now = verdict(modes);
    const isAgain = time === this.time;
    const what = isAgain || now === this.before || now === this.line.dataset.verdict ? now : undefined;
    this.time = time;
    this.before = now;
    if (what) this.since = time;
    else if (frame && !isAgain && time >= this.since && time < this.since + hold) return;
    this.line.hidden = !what;
    this.line.dataset.verdict = what ?? "";
    this.line.replaceChildren(...(what ? sentence(method, modes!, what) : []));
  }
}
