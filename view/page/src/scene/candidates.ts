import type { Candidates } from "../protocol";
import { theme } from "../theme";
import { costTerms, term } from "./layers";
import type { Painter } from "./painter";
import { rampColour, type Rgba } from "./palette";
import { faded } from "./shapes";

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
