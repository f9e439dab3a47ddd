// The colours of the scene as people with a colour vision deficiency see them: the simulation of Machado, Oliveira and
// Fernandes (IEEE TVCG 15(6), 2009, table 1, severity 1.0) in linear RGB, and distances in OKLab.
import { readFileSync } from "node:fs";
import { transform } from "esbuild";

const simulations = {
  normal: [1, 0, 0, 0, 1, 0, 0, 0, 1],
  protanopia: [0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998],
  deuteranopia: [0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.01182, 0.04294, 0.968881],
  tritanopia: [1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.3039],
};
// What is drawn alike, so that only its colour tells it apart. Dashed lines, dots and hollow shapes are not in a group
// with solid ones.
const alike = [["plan", "driven", "guide", "ghost", "collided"], ["path", "nominal"], ["car", "obstacle", "opponent", "ghost"]];
const least = 0.06; // distance in OKLab

const linear = (v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
const times = (m, [r, g, b]) => [0, 3, 6].map((i) => Math.min(1, Math.max(0, m[i] * r + m[i + 1] * g + m[i + 2] * b)));
function oklab([r, g, b]) {
  const l = Math.cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const m = Math.cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const s = Math.cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return [0.2104542553 * l + 0.793617785 * m - 0.0040720468 * s, 1.9779984951 * l - 2.428592205 * m + 0.4505937099 * s, 0.0259040371 * l + 0.7827717662 * m - 0.808675766 * s];
}

/** Pairs of layers that are drawn alike and that somebody cannot tell apart, in one line each. */
export async function similarColours() {
  const { code } = await transform(readFileSync(new URL("../src/scene/palette.ts", import.meta.url), "utf8"), { loader: "ts" });
  const { themes } = await import("data:text/javascript," + encodeURIComponent(code));
  const found = [];
  for (const [name, theme] of Object.entries(themes))
    for (const [vision, matrix] of Object.entries(simulations)) {
      const seen = (layer) => oklab(times(matrix, theme[layer].slice(0, 3).map(linear)));
      for (const group of alike)
        for (const [i, a] of group.entries())
          for (const b of group.slice(i + 1)) {
            const distance = Math.hypot(...seen(a).map((v, k) => v - seen(b)[k]));
            if (distance < least) found.push(`${name}, ${vision}: ${a} and ${b} differ by ${distance.toFixed(3)}`);
          }
    }
  return found;
}
