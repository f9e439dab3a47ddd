import { html, type Markup } from "./html";
import type { Body, Frame } from "./protocol";

/** On which side of an obstacle something passes: left, right, or into it. */
type Side = "left" | "right" | "into";

/** How a controller passes the next obstacle: where its plan leads, and the weight of the samples on either side. */
interface Modes {
  obstacle: Body;
  plan: Side;
  left: number; // share of the weight, 0 ... 1
  right: number;
}

type Place = { x: number; y: number };
const halfCar = 0.155; // m, half the width of the car

/** The lateral offset (m, left is positive) at which a trajectory passes an obstacle, or undefined if it ends before. */
function offset(points: number, at: (i: number) => Place, from: Place, obstacle: Place): number | undefined {
  const dx = obstacle.x - from.x, dy = obstacle.y - from.y, length = Math.hypot(dx, dy), c = dx / length, s = dy / length;
  for (let i = 1; i < points; ++i) {
    const b = at(i), ahead = c * (b.x - obstacle.x) + s * (b.y - obstacle.y);
    if (ahead < 0) continue;
    const a = at(i - 1), before = c * (a.x - obstacle.x) + s * (a.y - obstacle.y), share = ahead > before ? -before / (ahead - before) : 0;
    const x = a.x + share * (b.x - a.x), y = a.y + share * (b.y - a.y);
    return c * (y - obstacle.y) - s * (x - obstacle.x);
  }
  return undefined;
}

/** The nearest obstacle that the plan passes within `beside` m. */
function nextObstacle(frame: Frame, beside: number): Body | undefined {
  const [car, plan] = [frame.bodies[0], frame.plan];
  if (!car || !plan?.length) return undefined;
  let nearest: Body | undefined, least = Infinity;
  for (const body of frame.bodies) {
    if (body.kind === 0 || body.kind === 4) continue;
    const ahead = Math.cos(car.yaw) * (body.x - car.x) + Math.sin(car.yaw) * (body.y - car.y), distance = Math.hypot(body.x - car.x, body.y - car.y);
    if (ahead <= 0 || distance >= least || !plan.some((p) => Math.hypot(p.x - body.x, p.y - body.y) < beside)) continue;
    nearest = body;
    least = distance;
  }
  return nearest;
}

/** How the controller of a frame passes the next obstacle; undefined where there is none or the plan ends before it. */
export function modesOf(frame: Frame): Modes | undefined {
  const obstacle = nextObstacle(frame, 1.2), plan = frame.plan, candidates = frame.candidates;
  if (!obstacle || !plan || !candidates) return undefined;
  const from = frame.bodies[0], reach = (obstacle.kind === 3 ? obstacle.length / 2 : obstacle.width / 2) + halfCar;
  const side = (at: number): Side => (Math.abs(at) < reach ? "into" : at > 0 ? "left" : "right");
  const planned = offset(plan.length, (i) => plan[i], from, obstacle);
  if (planned === undefined) return undefined;
  const weights = { left: 0, right: 0, into: 0 };
  for (let k = 0; k < candidates.count; ++k) {
    const at = offset(candidates.points, (i) => ({ x: candidates.xy[2 * (k * candidates.points + i)], y: candidates.xy[2 * (k * candidates.points + i) + 1] }), from, obstacle);
    if (at !== undefined) weights[side(at)] += candidates.terms[5 * k + 4];
  }
  const all = weights.left + weights.right + weights.into;
  return { obstacle, plan: side(planned), left: all > 0 ? weights.left / all : 0, right: all > 0 ? weights.right / all : 0 };
}

/** Says what a method does at the next obstacle: its verdict, the figures, and what follows. */
function sentence(method: string, modes: Modes, what: "averages" | "commits"): Markup {
  const percent = (share: number) => `${Math.round(100 * share)} %`;
  if (what === "averages") return html`<b>${method} averages:</b> ${percent(modes.left)} of the weight left, ${percent(modes.right)} right.<span class="long"> The plan between them leads into the obstacle.</span>`;
  return html`<b>${method} commits:</b> the plan and ${percent(modes[modes.plan as "left" | "right"])} of the weight pass ${modes.plan}.`;
}

const both = 0.15; // share of the weight on the lighter side from which on both ways count
const one = 0.9; // share from which on one way is chosen

/**
 * `averages`: samples of both ways have weight, and the plan between them leads into the obstacle. `commits`: the plan
 * and nearly all of the weight are on one side.
 */
export function verdict(modes: Modes | undefined): "averages" | "commits" | undefined {
  if (!modes) return undefined;
  if (modes.plan === "into") return Math.min(modes.left, modes.right) >= both ? "averages" : undefined;
  return modes[modes.plan] >= one ? "commits" : undefined;
}

const hold = 0.5; // s of simulated time that a sentence stays, so that it can be read

/** The sentence over a scene. Another verdict is shown once it has held for two frames. */
export class Caption {
  private since = 0; // s
  private before?: "averages" | "commits"; // verdict of the frame before

  constructor(private readonly line: HTMLElement) {}

  /** Shows what a frame says at a time (s); without a frame nothing. */
  show(method: string, frame: Frame | undefined, time: number) {
    const modes = frame && modesOf(frame), now = verdict(modes), what = now === this.before || now === this.line.dataset.verdict ? now : undefined;
    this.before = now;
    if (what) this.since = time;
    else if (frame && time >= this.since && time < this.since + hold) return;
    this.line.hidden = !what;
    this.line.dataset.verdict = what ?? "";
    this.line.innerHTML = what ? sentence(method, modes!, what).text : "";
  }
}
