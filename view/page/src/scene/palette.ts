// Colours computed in OKLab (B. Ottosson, 2020), where equal steps look equal. The cost ramp runs from blue to yellow
// with lightness that only rises, so it reads the same with any kind of colour vision and in grey.

export type Rgba = [number, number, number, number];

function oklch(lightness: number, chroma: number, hue: number): [number, number, number] {
  const a = chroma * Math.cos(hue), b = chroma * Math.sin(hue);
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

function ramp(dark: boolean): Float32Array {
  const table = new Float32Array(steps * 3);
  for (let i = 0; i < steps; ++i) {
    const t = i / (steps - 1);
    // Good candidates are to stand out of the ground, whatever its brightness.
    const lightness = dark ? 0.9 - 0.5 * t : 0.36 + 0.47 * t;
    const hue = dark ? 1.85 + 2.75 * t ** 0.9 : 4.65 - 2.85 * t ** 1.1;
    const chroma = 0.115 + 0.045 * Math.sin(Math.PI * t);
    table.set(oklch(lightness, chroma, hue), 3 * i);
  }
  return table;
}

export interface Theme {
  dark: boolean;
  ramp: Float32Array; // best to worst
  ground: Rgba; free: Rgba; wall: Rgba; wallEdge: Rgba; unknown: Rgba; cost: Rgba;
  path: Rgba; scan: Rgba; collided: Rgba; guide: Rgba; nominal: Rgba; plan: Rgba; spread: Rgba; driven: Rgba;
  car: Rgba; carEdge: Rgba; wheel: Rgba; obstacle: Rgba; obstacleEdge: Rgba; ghost: Rgba; selected: Rgba; grid: Rgba; opponent: Rgba; mark: Rgba;
}

const hex = (text: string, alpha = 1): Rgba => [
  parseInt(text.slice(1, 3), 16) / 255, parseInt(text.slice(3, 5), 16) / 255, parseInt(text.slice(5, 7), 16) / 255, alpha,
];

export const themes: Record<"dark" | "light", Theme> = {
  dark: {
    dark: true, ramp: ramp(true),
    ground: hex("#0a0d12"), free: hex("#1b222c"), wall: hex("#0a0d12"), wallEdge: hex("#6b7d95"), unknown: hex("#0b0e13"), cost: hex("#e2663a", 0.2),
    path: hex("#7f8ea3", 0.6), scan: hex("#8fd3ff", 0.85), collided: hex("#ff5a36", 0.42), guide: hex("#f4a8ff", 0.95),
    nominal: hex("#ffffff", 0.75), plan: hex("#3ff2c8"), spread: hex("#3ff2c8", 0.11), driven: hex("#7b8cff", 0.9),
    car: hex("#f3f6fa"), carEdge: hex("#0b0e13"), wheel: hex("#2b3340"), obstacle: hex("#e8a13a"), obstacleEdge: hex("#fff1d6"),
    ghost: hex("#9060b4", 0.85), selected: hex("#ffffff"), grid: hex("#ffffff", 0.045), opponent: hex("#59b7f0"), mark: hex("#ff5a36", 0.95),
  },
  light: {
    dark: false, ramp: ramp(false),
    ground: hex("#cfd7e0"), free: hex("#fbfcfd"), wall: hex("#cfd7e0"), wallEdge: hex("#3b4858"), unknown: hex("#dfe4ea"), cost: hex("#d1491b", 0.15),
    path: hex("#6b7a8d", 0.6), scan: hex("#0069b4", 0.8), collided: hex("#c93410", 0.4), guide: hex("#a01bb0", 0.95),
    nominal: hex("#20262e", 0.7), plan: hex("#00876c"), spread: hex("#00876c", 0.11), driven: hex("#4353d8", 0.85),
    car: hex("#1d2530"), carEdge: hex("#ffffff"), wheel: hex("#66738a"), obstacle: hex("#d98518"), obstacleEdge: hex("#5c3500"),
    ghost: hex("#4a1470", 0.85), selected: hex("#000000"), grid: hex("#000000", 0.05), opponent: hex("#1273b8"), mark: hex("#c93410", 0.95),
  },
};

/** The colour of a value in [0, 1], best to worst. */
export function rampColour(theme: Theme, value: number, alpha: number): Rgba {
  const i = Math.min(steps - 1, Math.max(0, Math.round(value * (steps - 1)))) * 3;
  return [theme.ramp[i], theme.ramp[i + 1], theme.ramp[i + 2], alpha];
}

export function rampCss(theme: Theme): string {
  const stops = [];
  for (let i = 0; i <= 8; ++i) {
    const c = rampColour(theme, i / 8, 1);
    stops.push(`rgb(${c.slice(0, 3).map((v) => Math.round(255 * v)).join(" ")}) ${(100 * i) / 8}%`);
  }
  return `linear-gradient(90deg, ${stops.join(", ")})`;
}
