import { terms, type Term } from "./layers";
import { rampColour, type Rgba, type Theme } from "./palette";
import type { Candidates } from "../protocol";
import { faded } from "./shapes";

/** How the candidates of a frame are drawn; `order`: those with the least cost last. */
export interface CandidateLook {
  order: number[];
  colours: Rgba[];
  widths: number[];
  range: [number, number];
}

/** Colours by a term of the cost, width and opacity by the weight. `range`: costs of the colour scale. */
export function lookOf(c: Candidates, theme: Theme, term: Term, range?: [number, number]): CandidateLook {
  const k = terms.indexOf(term);
  const all = Array.from({ length: c.count }, (_, i) => i);
  const value = (i: number) => (k < 3 ? c.terms[5 * i + k] : c.terms[5 * i + 3]);
  const weight = (i: number) => c.terms[5 * i + 4];
  const sorted = all
    .filter((i) => !c.collided[i] || k === 2)
    .map(value)
    .filter(Number.isFinite)
    .sort((a, b) => a - b);
  // The worst tenth shares the end of the scale, so that the many good ones can be told apart.
  const least = sorted[0] ?? 0;
  const [low, high] = range ?? [
    least,
    Math.max(least + 1e-9, sorted[Math.floor(0.9 * (sorted.length - 1))] ?? 1),
  ];
  // Their number is small where the weight is concentrated, so a share of the largest weight is shown.
  const heaviest = Math.max(1e-12, ...all.map(weight));
  const share = (i: number) => Math.sqrt(weight(i) / heaviest);
  const cost = (i: number) => Math.min(1, Math.max(0, (value(i) - low) / (high - low)));
  return {
    order: [...all].sort((a, b) => c.collided[b] - c.collided[a] || value(b) - value(a)),
    colours: all.map((i) =>
      c.collided[i]
        ? faded(theme.collided, 0.7 + 0.3 * share(i))
        : rampColour(theme, cost(i), 0.5 - 0.25 * cost(i) + 0.5 * share(i)),
    ),
    widths: all.map((i) => (c.collided[i] ? 1 : 1 + 2 * share(i))),
    range: [low, high],
  };
}
