import { page } from "../page";
import type { Body, Candidates, Frame } from "../protocol";
import { theme } from "../theme";
import { costTerms, term } from "./layers";
import type { Painter } from "./painter";
import { rampColour, type Rgba } from "./palette";
import { drawCross, faded } from "./shapes";

const unknown = 255; // a candidate that collides, but it is not known where

/** The index of the point at which a candidate collides; undefined if it does not, or if it is not known. */
export function collisionPoint({ candidates }: Frame, i: number): number | undefined {
  const at = candidates?.collided[i] || unknown;
  return at < unknown ? at - 1 : undefined;
}

const kindNames = ["", "a parked car", "a box", "a pole", "another car", "somebody"];

/** Names what a candidate meets at one of its points: a body whose edge is within reach, or a wall. */
export function bodyHit({ bodies, candidates: c }: Frame, i: number, point: number): string {
  const [x, y] = c!.xy.subarray(2 * (i * c!.points + point));
  const { length } = page.hello!.body;
  const reach = 1.1 * length; // m, from the rear axle of a car to its front
  const distance = (b: Body) => {
    const [cos, sin, dx, dy] = [Math.cos(b.yaw), Math.sin(b.yaw), x - b.x, y - b.y];
    if (b.kind === 3 || b.kind === 5) return Math.hypot(dx, dy) - b.length / 2;
    const u = Math.abs(cos * dx + sin * dy) - b.length / 2;
    const v = Math.abs(cos * dy - sin * dx) - b.width / 2;
    return Math.hypot(Math.max(0, u), Math.max(0, v));
  };
  const nearest = bodies.filter((b) => b.kind > 0 && b.kind < 6).sort((a, b) => distance(a) - distance(b))[0];
  if (nearest && distance(nearest) < reach) return kindNames[nearest.kind];
  return page.scene?.grid ? "a wall" : "";
}

/** The candidate that passes nearest to a point of the map frame, within `reach` (m); -1 if there is none. */
export function candidateAt({ candidates: c }: Frame, x: number, y: number, reach: number): number {
  let found = -1;
  for (let k = 0; c && k < c.count * c.points; ++k) {
    if (k % c.points === 0) continue;
    const [ax, ay, bx, by] = c.xy.subarray(2 * k - 2, 2 * k + 2);
    const length = (bx - ax) ** 2 + (by - ay) ** 2;
    const along = ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / (length || 1);
    const share = Math.min(1, Math.max(0, along));
    const distance = Math.hypot(ax + share * (bx - ax) - x, ay + share * (by - ay) - y);
    if (distance < reach) [reach, found] = [distance, Math.floor(k / c.points)];
  }
  return found;
}

/** Draws the candidate that is chosen, and a cross where it collides. */
export function drawChosen(painter: Painter, frame: Frame, i: number, cross: number) {
  const c = frame.candidates!;
  painter.polyline(c.xy, i * c.points, c.points, theme.ground, 6);
  painter.polyline(c.xy, i * c.points, c.points, theme.selected, 3);
  const at = collisionPoint(frame, i);
  if (at === undefined) return;
  const [x, y] = c.xy.subarray(2 * (i * c.points + at));
  drawCross(painter, { x, y }, cross);
}

/** Costs of the candidates' first and last colour. */
export let costRange: [number, number] = [0, 1];

/** Sets the costs of the colour scale to those of these candidates. */
export function scaleCosts(c: Candidates) {
  const all = Array.from({ length: c.count }, (_, i) => i);
  const shown = all.filter((i) => !c.collided[i] || term === "collision").map((i) => costOf(c, i));
  const sorted = shown.filter(Number.isFinite).sort((a, b) => a - b);
  // The worst tenth shares the end of the scale, so that the many good ones can be told apart.
  const least = sorted[0] ?? 0;
  costRange = [least, Math.max(least + 1e-9, sorted[Math.floor(0.9 * (sorted.length - 1))] ?? 1)];
}
/** The cost of a candidate by the term that is chosen. */
const costOf = (c: Candidates, i: number) => c.terms[c.width * i + Math.max(0, costTerms().indexOf(term))];

/**
 * Draws candidates, those with the least cost last: coloured by a term of the cost, wide and opaque by their
 * weight.
 */
export function drawCandidates(painter: Painter, c: Candidates) {
  const all = Array.from({ length: c.count }, (_, i) => i);
  const draw = (i: number, colour: Rgba, width: number) =>
    painter.polyline(c.xy, i * c.points, c.points, colour, width);
  if (term === "density") {
    // Wide lines that are nearly clear add up where the candidates are dense.
    for (const i of all) draw(i, faded(c.collided[i] ? theme.mark : theme.plan, 0.07), 7);
    return;
  }
  const [low, high] = costRange;
  const weight = (i: number) => c.terms[c.width * (i + 1) - 1];
  // Their number is small where the weight is concentrated, so a share of the largest weight is shown.
  const heaviest = Math.max(1e-12, ...all.map(weight));
  for (const i of all.sort((a, b) => c.collided[b] - c.collided[a] || costOf(c, b) - costOf(c, a))) {
    const share = Math.sqrt(weight(i) / heaviest);
    const cost = Math.min(1, Math.max(0, (costOf(c, i) - low) / (high - low)));
    if (c.collided[i]) draw(i, faded(theme.collided, 0.7 + 0.3 * share), 1);
    else draw(i, rampColour(theme, cost, 0.5 - 0.25 * cost + 0.5 * share), 1 + 2 * share);
  }
}
