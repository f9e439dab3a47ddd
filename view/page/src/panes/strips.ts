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

/** Names its lines as "label: scalar in colour". */
const strip = (
  title: string,
  ...lines: [name: string, label: string, colour: string, look?: Partial<Line>][]
): Strip => ({
  title,
  lines: lines.map(([name, label, colour, look]) => ({ name, label, colour: `--${colour}`, ...look })),
});

// Lines can be told apart with any colour vision: they differ in lightness, too, and some are dashed.
export const strips: Strip[] = [
  strip(
    "Cost of the plan",
    ["distance_cost", "distance", "blue"],
    ["yaw_cost", "yaw", "violet", { dash: [6, 3] }],
    ["collision_cost", "collision", "bad", { dash: [2, 2] }],
  ),
  strip(
    "Steering, rad",
    ["command_steer", "command", "accent", { digits: 3 }],
    ["steer", "wheels", "text", { dash, digits: 3 }],
  ),
  strip("Speed, m/s", ["command_speed", "command", "accent"], ["speed", "car", "text", { dash }]),
  strip(
    "Slip angle, rad",
    ["slip_estimate", "estimate", "accent", { digits: 3 }],
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
    ["friction_estimate", "estimate", "accent"],
    ["friction_relied_on", "relied on", "blue", { dash }],
  ),
  strip(
    "Steering, estimates",
    ["steering_gain_estimate", "gain", "accent", { digits: 3 }],
    ["delay_estimate", "delay, ms", "violet", { dash, right: true, digits: 0, scale: 1000 }],
  ),
  strip(
    "Samples",
    ["effective_samples", "ESS", "blue", { digits: 0 }],
    ["temperature", "temperature", "warn", { dash, right: true }],
  ),
  strip("Collided candidates, %", ["collided_share", "share", "bad", { digits: 0, scale: 100 }]),
  strip("Clearance, m", ["clearance", "to wall or obstacle", "accent"]),
];

/** The unit of a line, at the end of its label or of the title: "rad", "%"; empty if it has none. */
export const unitOf = ({ title }: Strip, { label }: Line) =>
  /, (\S+)$/.exec(label)?.[1] ??
  (title.startsWith("Steering, estimates") ? "" : (/, (\S+)/.exec(title)?.[1] ?? ""));

/** Whether a line has no value where tyres do not slip. */
export const isEstimate = (line: Line) => line.name.endsWith("_estimate") || line.name === "grip_used";
