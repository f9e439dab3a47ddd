import type { Hello } from "../protocol";

/** A line of a chart: the scalar that it shows, its label, the colour's CSS variable, and how it is drawn. */
export interface Line {
  name: string;
  label: string;
  colour: string;
  dash?: number[];
  right?: boolean; // has the axis on the right
  digits?: number;
  scale?: number; // from the scalar to what is shown
}
/** A chart over time. */
export interface Strip {
  title: string;
  lines: Line[];
}

const dash = [5, 3];

type Named = [name: string, label: string, colour: string, look?: Partial<Line>];

/** Names its lines as "label: scalar in colour". */
const strip = (title: string, ...lines: Named[]): Strip => ({
  title,
  lines: lines.map(([name, label, colour, look]) => ({ name, label, colour: `--${colour}`, ...look })),
});

/** Charts of figures that not all drives have. */
const known: Strip[] = [
  strip(
    "Steering, rad",
    ["command_steer", "command", "blue", { digits: 3 }],
    ["steer", "wheels", "text", { dash, digits: 3 }],
  ),
  strip("Speed, m/s", ["command_speed", "command", "blue"], ["speed", "car", "text", { dash }]),
  strip(
    "Slip angle, rad",
    ["slip_estimate", "estimate", "blue", { digits: 3 }],
    ["slip", "car", "text", { dash, digits: 3 }],
  ),
  strip("Grip used, % of friction times gravity", [
    "grip_used",
    "to the side",
    "warn",
    { digits: 0, scale: 100 },
  ]),
  strip(
    "Friction",
    ["friction_estimate", "estimate", "blue"],
    ["friction_relied_on", "relied on", "text", { dash }],
  ),
  strip(
    "Steering, estimates",
    ["steering_gain_estimate", "gain", "blue", { digits: 3 }],
    ["delay_estimate", "delay, ms", "violet", { dash, right: true, digits: 0, scale: 1000 }],
  ),
  strip(
    "Samples",
    ["effective_samples", "ESS", "blue", { digits: 0 }],
    ["temperature", "temperature", "warn", { dash, right: true }],
  ),
  strip("Collided candidates, %", ["collided_share", "share", "bad", { digits: 0, scale: 100 }]),
  strip("Clearance, m", ["clearance", "to wall or obstacle", "blue"]),
];

/**
 * The colours of the lines of a chart, with their dashes. Lines can be told apart with any colour vision: they
 * differ in lightness, too, and some are dashed.
 */
const looks: [colour: string, dash?: number[]][] = [
  ["blue"],
  ["text", dash],
  ["warn"],
  ["violet", dash],
  ["faint"],
  ["bad", [2, 2]],
];

function lineOf(name: string, label: string, i: number): Named {
  const [colour, dashes] = looks[i % looks.length];
  return [name, label, colour, { dash: i < looks.length ? dashes : [12, 3] }];
}

/** Charts of values whose names end with their units, "speed, m/s": those of one unit share a chart. */
function grouped(kind: string, names: string[]): Strip[] {
  const units = new Map<string, string[]>();
  for (const name of names) {
    const unit = /, (\S+)$/.exec(name)?.[1] ?? name;
    units.set(unit, [...(units.get(unit) ?? []), name]);
  }
  return [...units].map(([unit, all]) => {
    const short = (name: string) => name.replace(`, ${unit}`, "");
    const suffix = all[0] === unit ? "" : `, ${unit.replace("^2", "²")}`;
    const title = all.map(short).join(" · ") + suffix;
    const lines = all.map((name, i) => lineOf(kind + name, short(name), i));
    return strip(title[0].toUpperCase() + title.slice(1), ...lines);
  });
}

/** Words of titles, and what the charts with them show. */
const meanings: [word: string, meaning: string][] = [
  ["Cost", "Sum of each cost term along the plan: lower is better"],
  ["Slip", "Angle from where the car points to where it moves"],
  ["Grip", "Force of the tyres to the side, as a share of what the ground can give"],
  ["Friction", "Friction coefficient of the ground, as learned, and as plans rely on"],
  ["estimates", "What the car learned: how far its wheels turn for a command of 1, and how late"],
  ["Samples", "ESS: how many share the weight; temperature: extra cost that divides a weight by e"],
  ["Clearance", "Distance from the body"],
  ["Collided", "Share of the sampled control sequences that would collide"],
  ["deviation", "How far samples spread around the plan, at each time along it"],
  ["time", "Missed: commands that took longer than the deadline, the time between commands"],
];
export const meaningOf = (title: string) => meanings.find(([word]) => title.includes(word))?.[1] ?? "";

/** The charts of a drive: of the figures that it has. */
export function stripsOf({ scalars, terms, inputs, states }: Hello): Strip[] {
  const costs = terms.map((term, i) => lineOf(`${term}_cost`, term, i));
  const all = [
    strip("Cost of the plan", ...costs),
    ...grouped("input.", inputs),
    ...grouped("state.", states),
    ...known,
  ];
  return all.filter(({ lines }) => lines.every(({ name }) => scalars.includes(name)));
}

/** The unit of a line, at the end of its label or of the title: "rad", "%"; empty if it has none. */
export const unitOf = ({ title }: Strip, { label }: Line) =>
  /, (\S+)$/.exec(label)?.[1] ??
  (title.startsWith("Steering, estimates") ? "" : (/, (\S+)/.exec(title)?.[1] ?? ""));
