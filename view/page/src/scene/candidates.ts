import { terms, type Term } from "./layers";
import type { Painter } from "./painter";
import { rampColour, type Theme } from "./palette";
import type { Candidates } from "../protocol";
import { faded } from "./shapes";

type Range = [number, number];

/**
 * Draws candidates, those with the least cost last: coloured by a term of the cost, wide and opaque by their
 * weight. `range`: costs of the colour scale, by default those of these candidates. Returns the range.
 */
export function drawCandidates(
  painter: Painter,
  theme: Theme,
  c: Candidates,
  term: Term,
  range?: Range,
): Range {
  const k = terms.indexOf(term);
  const all = Array.from({ length: c.count }, (_, i) => i);
  const value = (i: number) => c.terms[5 * i + k];
  const weight = (i: number) => c.terms[5 * i + 4];
  const shown = all.filter((i) => !c.collided[i] || term === "collision").map(value);
  const sorted = shown.filter(Number.isFinite).sort((a, b) => a - b);
  // The worst tenth shares the end of the scale, so that the many good ones can be told apart.
  const least = sorted[0] ?? 0;
  const most = sorted[Math.floor(0.9 * (sorted.length - 1))] ?? 1;
  const [low, high] = range ?? [least, Math.max(least + 1e-9, most)];
  // Their number is small where the weight is concentrated, so a share of the largest weight is shown.
  const heaviest = Math.max(1e-12, ...all.map(weight));
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
