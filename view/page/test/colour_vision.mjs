// The colours of the scene as people with a colour vision deficiency see them: the simulation of Machado,
// Oliveira and Fernandes (IEEE TVCG 15(6), 2009, table 1, severity 1.0), and distances in OKLab.
import { readFileSync } from "node:fs";
import { transform } from "esbuild";

const simulations = {
  normal: [1, 0, 0, 0, 1, 0, 0, 0, 1],
  protanopia: [0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998],
  deuteranopia: [0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.01182, 0.04294, 0.968881],
  tritanopia: [1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.3039],
};
// Layers that only their colour tells apart: all of a group are solid lines, or dashed ones, or bodies.
const alike = [
  ["plan", "driven", "guide", "ghost", "collided"],
  ["path", "nominal"],
  ["car", "obstacle", "opponent", "ghost"],
];
const least = 0.06; // distance in OKLab
const toLms = [
  [0.4122214708, 0.5363325363, 0.0514459929],
  [0.2119034982, 0.6806995451, 0.1073969566],
  [0.0883024619, 0.2817188376, 0.6299787005],
];
const toOklab = [
  [0.2104542553, 0.793617785, -0.0040720468],
  [1.9779984951, -2.428592205, 0.4505937099],
  [0.0259040371, 0.7827717662, -0.808675766],
];

const linear = (v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
const product = (rows, v) => rows.map((row) => row.reduce((sum, each, i) => sum + each * v[i], 0));
const rowsOf = (m) => [m.slice(0, 3), m.slice(3, 6), m.slice(6)];
const clipped = (v) => v.map((each) => Math.min(1, Math.max(0, each)));
const oklab = (rgb) => product(toOklab, product(toLms, rgb).map(Math.cbrt));

async function palette() {
  const source = readFileSync(new URL("../src/scene/palette.ts", import.meta.url), "utf8");
  const { code } = await transform(source, { loader: "ts" });
  return import("data:text/javascript," + encodeURIComponent(code));
}

/** Colours of pictures and videos, by name, and those of the page for the same. */
export async function coloursByMeaning() {
  const source = readFileSync(new URL("../../../tools/drawing/drawing.hpp", import.meta.url), "utf8");
  const { themes, rampColour } = await palette();
  const hex = (rgb) => rgb.slice(0, 3).reduce((sum, v) => 256 * sum + Math.round(255 * v), 0);
  const named = [...source.matchAll(/(\w+)_colour = hex\((0x\w+)/g)].map(([, name, rgb]) => [
    name,
    Number(rgb),
  ]);
  const stops = /quantity_stops\[\] = {(.*?)};/s.exec(source)[1].match(/0x\w+/g).map(Number);
  const own = named.map(([name]) => [name, hex(themes.light[name === "hit" ? "collided" : name])]);
  return [
    [...named, stops],
    [...own, stops.map((_, i) => hex(rampColour(themes.light, i / (stops.length - 1), 1)))],
  ];
}

/** Pairs of layers that are drawn alike and that somebody cannot tell apart, in one line each. */
export async function similarColours() {
  const { themes } = await palette();
  const found = [];
  for (const [name, theme] of Object.entries(themes))
    for (const [vision, matrix] of Object.entries(simulations)) {
      const seen = (layer) => oklab(clipped(product(rowsOf(matrix), theme[layer].slice(0, 3).map(linear))));
      for (const [a, b] of alike.flatMap((group) =>
        group.flatMap((a, i) => group.slice(i + 1).map((b) => [a, b])),
      )) {
        const distance = Math.hypot(...seen(a).map((v, k) => v - seen(b)[k]));
        if (distance < least)
          found.push(`${name}, ${vision}: ${a} and ${b} differ by ${distance.toFixed(3)}`);
      }
    }
  return found;
}
