// Colours by meaning. Those in between are computed in OKLab (B. Ottosson, 2020), where equal steps look equal. The
// ramp of costs runs from blue to yellow with lightness in one direction, so it reads the same with any kind of colour
// vision and in grey. No other thing is green but the plan. Pictures and videos have the colours of the light theme
// (tools/drawing/drawing.hpp).

export type Rgba = [number, number, number, number];

function oklch(lightness: number, chroma: number, hue: number): [number, number, number] {
  const a = chroma * Math.cos(hue);
  const b = chroma * Math.sin(hue);
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  const linear = [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
  return linear.map((v) => {
    const c = Math.min(1, Math.max(0, v));
    return c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055;
  }) as [number, number, number];
}

const steps = 256;

/** From the best to the worst: from blue to yellow, and on both grounds from what stands out to what is faint. */
function ramp(dark: boolean): Float32Array {
  const table = new Float32Array(steps * 3);
  const [best, worst] = dark ? [0.86, 0.46] : [0.36, 0.8];
  for (let i = 0; i < steps; ++i) {
    const t = i / (steps - 1);
    const blue = 0.12 * (1 - 2 * t); // less than 0 is yellow
    table.set(oklch(best + t * (worst - best), Math.abs(blue), blue > 0 ? 4.4 : 1.6), 3 * i);
  }
  return table;
}

/** The colours of the scene in the dark and in the light theme: #rrggbb, or #rrggbbaa with an opacity. */
const colours = {
  ground: ["#0a0d12", "#cfd7e0"],
  free: ["#1b222c", "#fbfcfd"],
  wall: ["#0a0d12", "#cfd7e0"],
  wallEdge: ["#6b7d95", "#3b4858"],
  cost: ["#e2663a33", "#d1491b26"],
  path: ["#7f8ea399", "#6b7a8d99"],
  scan: ["#c3cedcb0", "#4a586ab0"],
  collided: ["#ff5a366b", "#c9341066"],
  guide: ["#f4a8fff2", "#a01bb0f2"],
  nominal: ["#ffffffbf", "#20262eb2"],
  plan: ["#3fe08a", "#007a3d"],
  spread: ["#3fe08a1c", "#007a3d1c"],
  driven: ["#8d9aaae6", "#6b7787e6"],
  car: ["#f3f6fa", "#1d2530"],
  carEdge: ["#0b0e13", "#ffffff"],
  wheel: ["#2b3340", "#66738a"],
  obstacle: ["#e8a13a", "#d98518"],
  obstacleEdge: ["#fff1d6", "#5c3500"],
  ghost: ["#9060b4d9", "#4a1470d9"],
  selected: ["#ffffff", "#000000"],
  opponent: ["#59b7f0", "#1273b8"],
  mark: ["#ff5a36f2", "#c93410f2"],
} satisfies Record<string, [dark: string, light: string]>;

export interface Theme extends Record<keyof typeof colours, Rgba> {
  dark: boolean;
  ramp: Float32Array; // best to worst
}

function parsed(hex: string): Rgba {
  const at = (i: number) => parseInt(hex.slice(i, i + 2) || "ff", 16) / 255;
  return [at(1), at(3), at(5), at(7)];
}

function themeOf(dark: boolean): Theme {
  const entries = Object.entries(colours).map(([name, pair]) => [name, parsed(pair[dark ? 0 : 1])]);
  return { ...(Object.fromEntries(entries) as Record<keyof typeof colours, Rgba>), dark, ramp: ramp(dark) };
}

export const themes = { dark: themeOf(true), light: themeOf(false) };

/** The colour of a value in [0, 1], best to worst. */
export function rampColour(theme: Theme, value: number, alpha: number): Rgba {
  const i = Math.min(steps - 1, Math.max(0, Math.round(value * (steps - 1)))) * 3;
  return [theme.ramp[i], theme.ramp[i + 1], theme.ramp[i + 2], alpha];
}

export function rampCss(theme: Theme): string {
  const stops = Array.from({ length: 9 }, (_, i) => css(rampColour(theme, i / 8, 1)));
  return `linear-gradient(90deg, ${stops.join(", ")})`;
}

/** A colour as CSS has it. */
export function css([r, g, b, alpha]: Rgba): string {
  return `rgb(${[r, g, b].map((v) => Math.round(255 * v)).join(" ")} / ${alpha})`;
}
