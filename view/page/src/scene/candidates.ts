import { costTerms } from "./layers";
import type { Painter } from "./painter";
import { rampColour, type Theme } from "./palette";
import { page } from "../page";
import type { Body, Candidates, Frame } from "../protocol";
import { faded } from "./shapes";

type Range = [number, number];

/** The index of the point at which a candidate collides; undefined if it does not, or if it is not known. */
export function collisionPoint({ candidates }: Frame, i: number): number | undefined {
  const at = candidates?.collided[i] ?? 0;
  // That of a car has been free before, so 1 means that the place is not known.
  return at > (page.hello?.problem ? 0 : 1) ? at - 1 : undefined;
}

const kindNames = ["", "a parked car", "a box", "a pole", "another car", "somebody"];

/** Names what a candidate meets at one of its points: a body whose edge is within reach, or a wall. */
export function bodyHit({ bodies, candidates: c }: Frame, i: number, point: number): string {
  const { car, problem } = page.hello ?? {};
  const [x, y] = c!.xy.subarray(2 * (i * c!.points + point));
  const reach = (car?.length ?? Math.hypot(problem?.length ?? 0, problem?.width ?? 0) / 2) + 0.05; // m
  const distance = (b: Body) => {
    const [cos, sin, dx, dy] = [Math.cos(b.yaw), Math.sin(b.yaw), x - b.x, y - b.y];
    if (b.kind === 3 || b.kind === 5) return Math.hypot(dx, dy) - b.length / 2;
    const u = Math.abs(cos * dx + sin * dy) - b.length / 2;
    const v = Math.abs(cos * dy - sin * dx) - b.width / 2;
    return Math.hypot(Math.max(0, u), Math.max(0, v));
  };
  const nearest = bodies.filter((b) => b.kind > 0 && b.kind < 6).sort((a, b) => distance(a) - distance(b))[0];
  if (nearest && distance(nearest) < reach) return problem ? `shape ${nearest.id}` : kindNames[nearest.kind];
  return problem ? "" : "a wall";
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
export function drawChosen(painter: Painter, theme: Theme, frame: Frame, i: number, cross: number) {
  const c = frame.candidates!;
  painter.polyline(c.xy, i * c.points, c.points, theme.ground, 6);
  painter.polyline(c.xy, i * c.points, c.points, theme.selected, 3);
  const at = collisionPoint(frame, i);
  if (at === undefined) return;
  const [x, y] = c.xy.subarray(2 * (i * c.points + at));
  for (const up of [-cross, cross]) painter.segment(x - cross, y - up, x + cross, y + up, theme.mark, 3.5);
}

/**
 * Draws candidates, those with the least cost last: coloured by a term of the cost, wide and opaque by their
 * weight. `range`: costs of the colour scale, by default those of these candidates. Returns the range.
 */
export function drawCandidates(
  painter: Painter,
  theme: Theme,
  c: Candidates,
  term: string,
  range?: Range,
): Range {
  const k = Math.max(0, costTerms().indexOf(term));
  const all = Array.from({ length: c.count }, (_, i) => i);
  const value = (i: number) => c.terms[c.width * i + k];
  const weight = (i: number) => c.terms[c.width * (i + 1) - 1];
  const shown = all.filter((i) => !c.collided[i] || term === "collision").map(value);
  const sorted = shown.filter(Number.isFinite).sort((a, b) => a - b);
  // The worst tenth shares the end of the scale, so that the many good ones can be told apart.
  const least = sorted[0] ?? 0;
  const most = sorted[Math.floor(0.9 * (sorted.length - 1))] ?? 1;
  const [low, high] = range ?? [least, Math.max(least + 1e-9, most)];
  // Their number is small where the weight is concentrated, so a share of the largest weight is shown.
  const heaviest = Math.max(1e-12, ...all.map(weight));
  if (term === "density") {
    // Wide lines that are nearly clear add up where the candidates are dense.
    for (const i of all)
      painter.polyline(c.xy, i * c.points, c.points, faded(c.collided[i] ? theme.mark : theme.plan, 0.07), 7);
    return [low, high];
  }
  for (const i of all.sort((a, b) => c.collided[b] - c.collided[a] || value(b) - value(a))) {
    const share = Math.sqrt(weight(i) / heaviest);
    const cost = Math.min(1, Math.max(0, (value(i) - low) / (high - low)));
    const colour = c.collided[i]
      ? faded(theme.collided, 0.7 + 0.3 * share)
      : rampColour(theme, cost, 0.5 - 0.25 * cost + 0.5 * share);
    painter.polyline(c.xy, i * c.points, c.points, colour, c.collided[i] ? 1 : 1 + 2 * share);
  }
  return [low, high];
}
