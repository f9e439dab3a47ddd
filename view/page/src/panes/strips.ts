export interface Line { name: string; label: string; colour: string; dash?: number[]; right?: boolean; digits?: number; scale?: number }
/** A chart over time. One without a finite value is hidden: estimates exist only for cars whose tyres slip. */
export interface Strip { title: string; unit: string; lines: Line[] }

// Colours tell apart with any colour vision: they differ in lightness as well, and one of each pair is dashed.
export const strips: Strip[] = [
  { title: "Cost of the plan", unit: "", lines: [{ name: "distance_cost", label: "distance", colour: "--blue" }, { name: "yaw_cost", label: "yaw", colour: "--violet", dash: [6, 3] }, { name: "collision_cost", label: "collision", colour: "--bad", dash: [2, 2] }] },
  { title: "Steering", unit: "rad", lines: [{ name: "command_steer", label: "command", colour: "--accent", digits: 3 }, { name: "steer", label: "wheels", colour: "--text", dash: [5, 3], digits: 3 }] },
  { title: "Speed", unit: "m/s", lines: [{ name: "command_speed", label: "command", colour: "--accent" }, { name: "speed", label: "car", colour: "--text", dash: [5, 3] }] },
  { title: "Slip angle", unit: "rad", lines: [{ name: "slip_estimate", label: "estimate", colour: "--accent", digits: 3 }, { name: "slip", label: "car", colour: "--text", dash: [5, 3], digits: 3 }] },
  { title: "Grip used", unit: "% of friction times gravity", lines: [{ name: "grip_used", label: "to the side", colour: "--warn", digits: 0, scale: 100 }] },
  { title: "Friction", unit: "", lines: [{ name: "friction_estimate", label: "estimate", colour: "--accent" }, { name: "friction_relied_on", label: "relied on", colour: "--blue", dash: [5, 3] }] },
  { title: "Steering", unit: "estimates", lines: [{ name: "steering_gain_estimate", label: "gain", colour: "--accent", digits: 3 }, { name: "delay_estimate", label: "delay, ms", colour: "--violet", dash: [5, 3], right: true, digits: 0, scale: 1000 }] },
  { title: "Samples", unit: "", lines: [{ name: "effective_samples", label: "ESS", colour: "--blue", digits: 0 }, { name: "temperature", label: "temperature", colour: "--warn", dash: [5, 3], right: true }] },
  { title: "Collided candidates", unit: "%", lines: [{ name: "collided_share", label: "share", colour: "--bad", digits: 0, scale: 100 }] },
  { title: "Clearance", unit: "m", lines: [{ name: "clearance", label: "to wall or obstacle", colour: "--accent" }] },
];

/** Lines that have no value where tyres do not slip; `slip` is the simulator's and stands with its estimate. */
export const needsEstimates = (strip: Strip) => strip.lines.some((line) => line.name.endsWith("_estimate") || line.name === "grip_used");
