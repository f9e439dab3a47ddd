// The messages of the live view, which docs/live-view.md describes: in m, rad, s and the map frame where
// nothing else is said.

type Numbers<Names extends string> = Record<Names, number>;
export type Pose = Numbers<"x" | "y" | "yaw">;

export interface Trajectories {
  count: number;
  points: number; // points of each trajectory
  xy: Float32Array; // [trajectory][point][2]
}
export interface Candidates extends Trajectories {
  terms: Float32Array; // [trajectory][distance, yaw, collision, solver's cost, weight]
  collided: Uint8Array;
}
/** The trajectories are [iteration][guide]; the last iteration is where the guides ended. */
export interface Guides extends Trajectories {
  guides: number;
  iterations: number;
}
export interface PlanState extends Pose, Numbers<"speed" | "steer"> {
  spread: number; // lateral standard deviation
}
/** A body of the world; kinds: 0 driven, 1 parked car, 2 box, 3 disc, 4 opponent. */
export interface Body extends Pose, Numbers<"id" | "kind" | "length" | "width"> {
  touched: boolean; // it has collided
}
export interface Scan extends Pose {
  ranges: Uint16Array; // mm
}
/** Cells around a pose: row 0 at the largest x, column 0 at the largest y; the centre is relative to it. */
export interface CostMap extends Pose, Numbers<"rows" | "columns" | "resolution" | "centerX" | "centerY"> {
  cells: Uint8Array;
}
/** A car that is tracked: its box now, and the places where it is expected, for each hypothesis. */
export interface Other extends Pose, Numbers<"length" | "width" | "points"> {
  weights: Float32Array; // weights of the hypotheses
  xy: Float32Array; // [hypothesis][time][2]
}
export interface Ghost extends Pose, Numbers<"steer" | "speed" | "laps" | "lapTime"> {
  plan: Float32Array; // [point][2]
}
export interface Frame {
  scalars: Float64Array;
  scan?: Scan;
  costMap?: CostMap;
  candidates?: Candidates;
  guides?: Guides;
  nominal?: Trajectories;
  plan?: PlanState[];
  covariance?: Float32Array;
  bodies: Body[];
  others?: Other[];
  ghost?: Ghost;
  ghostFrame?: Frame; // frame of the ghost's controller, in the ghost's world
}
/** The map, with the corner of its first cell at a pose. */
export interface Grid extends Pose, Numbers<"width" | "height" | "resolution"> {
  cells: Uint8Array;
}
export interface Path {
  closed: boolean;
  xyv: Float32Array; // [point][x, y, speed]
}
export interface Scene {
  grid?: Grid;
  path?: Path;
}

export interface OptionDeclaration extends Record<
  "name" | "symbol" | "unit" | "help" | "value" | "default",
  string
> {
  type: "flag" | "integer" | "count" | "number" | "numbers" | "choice";
  min?: number;
  max?: number;
  choices?: string[];
}
export interface OptionSection {
  name: string;
  options: OptionDeclaration[];
}
export interface Hello extends Numbers<"protocol" | "history_seconds" | "control_period"> {
  type: "hello";
  scalars: string[];
  statuses: string[];
  courses: string[];
  methods: string[];
  configurations: string[];
  car: Numbers<"length" | "width" | "front" | "rear">;
  lidar: Numbers<"angle_min" | "angle_increment" | "range_max">;
}
export interface LapRow extends Numbers<"lap" | "time" | "contacts"> {
  method: string;
  ghost?: boolean;
}
type Names = "course" | "description" | "method" | "config" | "evaluation" | "seed" | "ghost" | "ghost_label";
type Counts =
  "length" | "obstacles" | "opponents" | "rate" | "tick" | "newest" | "oldest" | "time" | "generation";
export interface State extends Record<Names, string>, Numbers<Counts | "control_period"> {
  type: "state";
  paused: boolean;
  real_time: boolean;
  edited: boolean;
  introduction?: boolean;
  laps: LapRow[];
  contact?: Numbers<"experiment" | "lap" | "contact" | "tick">;
}
export interface Options extends Numbers<"undo" | "redo"> {
  type: "options";
  sections: OptionSection[];
  changed: string[];
  command_line: string;
  yaml: string;
}
export interface Problem {
  type: "error";
  message: string;
  id?: number;
}
export interface Done {
  type: "done";
  id: number;
}
/** Tells a page whether it drives or watches. */
export interface Role {
  type: "role";
  drives: boolean;
}
export interface Note {
  type: "note";
  message: string;
}
export interface EvaluationLap extends Numbers<"experiment" | "lap" | "time" | "contacts"> {
  seed: string;
  finished: boolean;
  points: [number, number][];
}
export interface Evaluation {
  type: "evaluation";
  folder: string;
  course: string;
  experiments: { label: string; scenario: string; obstacles: number }[];
  laps: EvaluationLap[];
}
export type Text = Hello | State | Options | Problem | Done | Role | Note | Evaluation;
