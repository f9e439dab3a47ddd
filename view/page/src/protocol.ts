// The messages of the live view, which docs/live-view.md describes: in m, rad, s and the map frame where
// nothing else is said.

/** Reads little-endian numbers one after the other. */
class Reader {
  constructor(
    private readonly view: DataView,
    public at: number,
    readonly end: number,
  ) {}

  private take(bytes: number) {
    if (this.at + bytes > this.end) throw new Error("a block is too short");
    this.at += bytes;
    return this.at - bytes;
  }
  u8 = () => this.view.getUint8(this.take(1));
  u16 = () => this.view.getUint16(this.take(2), true);
  i16 = () => this.view.getInt16(this.take(2), true);
  u32 = () => this.view.getUint32(this.take(4), true);
  f32 = () => this.view.getFloat32(this.take(4), true);
  f64 = () => this.view.getFloat64(this.take(8), true);
  private bytes = (n: number) => this.view.buffer.slice(this.take(n), this.at) as ArrayBuffer;
  f32s = (n: number) => new Float32Array(this.bytes(4 * n));
  u8s = (n: number) => new Uint8Array(this.bytes(n));
  f64s = () => new Float64Array(this.bytes(this.end - this.at));
  pose = () => ({ x: this.f64(), y: this.f64(), yaw: this.f64() });
  align = () => (this.at = (this.at + 3) & ~3);
  rest = () => new Uint8Array(this.view.buffer, this.at, this.end - this.at);

  /** Lines, each as x, y, x, y ... */
  lines = () => Array.from({ length: this.u32() }, () => this.f32s(2 * this.u32()));

  /** Points as an origin, a unit and differences of 16 bits: x, y, x, y ... */
  points(count: number): Float32Array {
    const [x, y, unit] = [this.f64(), this.f64(), this.f32()];
    const out = new Float32Array(count * 2);
    let [u, v] = [0, 0];
    for (let i = 0; i < count; ++i) {
      u = ((u + this.i16()) << 16) >> 16;
      v = ((v + this.i16()) << 16) >> 16;
      out[2 * i] = x + unit * u;
      out[2 * i + 1] = y + unit * v;
    }
    return out;
  }
}

/** Reads each block of a binary message; the types of the blocks follow from it. */
const blocks = {
  scalars: (r: Reader) => r.f64s(),
  past: (r: Reader) => r.f64s(), // the scalars of consecutive steps
  scan: (r: Reader) => ({ ...r.pose(), ranges: Uint16Array.from({ length: r.u32() }, r.u16) }), // mm
  /** Cells around a pose: row 0 at the largest x, column 0 at the largest y; the centre is relative to it. */
  costMap: (r: Reader) => {
    const pose = r.pose();
    const [rows, columns] = [r.u16(), r.u16()];
    const [resolution, centerX, centerY] = r.f32s(3);
    const bits = r.u8s(Math.ceil((rows * columns) / 8)); // 1 where occupied
    return { ...pose, rows, columns, resolution, centerX, centerY, bits };
  },
  /**
   * `terms`: of each trajectory its costs by term, the solver's cost and the weight, `width` values.
   * `collided`: 1 if it collides, else 0.
   */
  candidates: (r: Reader) => {
    const size = r.end - r.at;
    const [count, points] = [r.u16(), r.u16()];
    const others = 4 + ((count + 3) & ~3) + 20 + 4 * count * points; // bytes
    const width = (size - others) / (4 * count);
    const [terms, collided] = [r.f32s(count * width), r.u8s(count)];
    r.align();
    return { count, points, width, terms, collided, xy: r.points(count * points) };
  },
  lines: (r: Reader) => r.lines(), // to follow
  figure: (r: Reader) => r.lines(), // the body of a problem that is not a car
  polygons: (r: Reader) => r.lines(),
  /** The trajectories are [iteration][guide]; the last iteration is where the guides ended. */
  guides: (r: Reader) => {
    const [guides, iterations, points] = [r.u16(), r.u16(), r.u16(), r.u16()];
    return { guides, iterations, points, xy: r.points(guides * iterations * points) };
  },
  nominal: (r: Reader) => {
    const points = r.u32();
    return { points, xy: r.points(points) };
  },
  /** `spread`: lateral standard deviation. */
  plan: (r: Reader) => {
    const [length, x0, y0] = [r.u32(), r.f64(), r.f64()];
    return Array.from({ length }, () => {
      const [x, y, yaw, speed, steer, spread] = r.f32s(6);
      return { x: x0 + x, y: y0 + y, yaw, speed, steer, spread };
    });
  },
  /** Kinds: 0 driven, 1 parked car, 2 box, 3 disc, 4 opponent, 5 mover, 6 goal; `touched`: has collided. */
  bodies: (r: Reader) =>
    Array.from({ length: r.u32() }, () => {
      const [id, kind, touched] = [r.u16(), r.u8(), r.u8() !== 0];
      const [x, y, yaw, length, width] = r.f32s(5);
      return { id, kind, touched, x, y, yaw, length, width };
    }),
  covariance: (r: Reader) => r.f32s((r.end - r.at) / 4),
  /** Cars that are tracked: the box of now, and the places where each is expected, for each hypothesis. */
  others: (r: Reader) =>
    Array.from({ length: r.u32() }, () => {
      const [length, width, yaw] = r.f32s(3);
      const [count, points] = [r.u16(), r.u16()];
      const weights = r.f32s(count);
      const xy = r.points(count * points);
      return { x: xy[0], y: xy[1], yaw, length, width, weights, points, xy };
    }),
  /** The map, with the corner of its first cell at a pose. */
  grid: (r: Reader) => {
    const [width, height, resolution] = [r.u32(), r.u32(), r.f64()];
    const grid = { width, height, resolution, ...r.pose(), cells: new Uint8Array(width * height) };
    let to = 0;
    for (let runs = r.u32(); runs > 0; --runs) {
      const run = r.u32();
      const from = to;
      to += run & 0xffffff;
      grid.cells.fill(run >>> 24, from, to);
    }
    return grid;
  },
  /** The course line; `xyv`: x, y and speed of each point. */
  path: (r: Reader) => {
    const [n, closed] = [r.u32(), r.u32() !== 0];
    return { closed, xyv: r.f32s(3 * n) };
  },
  file: (r: Reader) => {
    const name = new TextDecoder().decode(r.u8s(r.u32()));
    r.align();
    return { name, content: r.rest() };
  },
};
/** The names of the blocks by their kinds; "-" where there is none. */
const kinds =
  "- scalars scan costMap candidates guides nominal plan bodies covariance - - others figure " +
  "polygons - - - - lines grid path past - - - - - - - file";
const names = kinds.split(" ") as (keyof typeof blocks)[];
export type Blocks = { [Name in keyof typeof blocks]: ReturnType<(typeof blocks)[Name]> };

/** A binary message. `ghostFrame`: the frame of the ghost's controller, in the ghost's world. */
export type Message = Partial<Blocks> & { ghostFrame?: Frame };
export type Frame = Message & Pick<Blocks, "scalars" | "bodies">;
export type Scene = Pick<Message, "grid" | "path">;
export type Body = Blocks["bodies"][number];
export type Candidates = Blocks["candidates"];
export type CostMap = Blocks["costMap"];
export type Grid = Blocks["grid"];
export type Guides = Blocks["guides"];
export type Other = Blocks["others"][number];
export type Path = Blocks["path"];
export type PlanState = Blocks["plan"][number];
export type Scan = Blocks["scan"];

const magic = 0x31564c53; // "SLV1"
const ghostFrame = 11; // kind of a block that is a message

/** Reads a binary message. Blocks of an unknown kind are of a later version and skipped. */
export function decode(buffer: ArrayBuffer): Message {
  const view = new DataView(buffer);
  if (view.byteLength < 4 || view.getUint32(0, true) !== magic)
    throw new Error("not a message of the live view");
  const message: Message = {};
  for (let at = 4; at + 8 <= view.byteLength;) {
    const kind = view.getUint16(at, true);
    const length = view.getUint32(at + 4, true);
    const r = new Reader(view, at + 8, Math.min(at + 8 + length, view.byteLength));
    at += 8 + ((length + 3) & ~3);
    const name = names[kind];
    if (kind === ghostFrame) message.ghostFrame = decode(buffer.slice(r.at, r.end)) as Frame;
    else if (name in blocks) Object.assign(message, { [name]: blocks[name](r) });
  }
  return message;
}

type Numbers<Names extends string> = Record<Names, number>;
type Texts<Names extends string> = Record<Names, string>;
export type Pose = Numbers<"x" | "y" | "yaw">;

export interface OptionDeclaration extends Texts<"name" | "symbol" | "unit" | "help" | "value" | "default"> {
  type: "flag" | "integer" | "count" | "number" | "numbers" | "choice";
  min?: number;
  max?: number;
  choices?: string[];
}
export interface Hello extends Numbers<"protocol" | "history_seconds" | "control_period"> {
  type: "hello";
  title: string;
  can: string[]; // place, move, add, scenario, real_time, save, ghost, introduction, watch
  scalars: string[];
  statuses: string[];
  symptoms: Texts<"name" | "explanation">[];
  courses: string[];
  methods: string[];
  configurations: string[];
  terms: string[]; // names of the cost terms
  states: string[];
  inputs: string[]; // with their units: "speed, m/s"
  /** Sizes of the driven body, and the distances of its axles from its middle: 0 without wheels. */
  body: Numbers<"length" | "width" | "front" | "rear">;
  lidar?: Numbers<"angle_min" | "angle_increment" | "range_max">;
}
export interface LapRow extends Numbers<"lap" | "time" | "contacts"> {
  method: string;
  ghost?: boolean;
}
type Names = "course" | "description" | "method" | "config" | "evaluation" | "seed" | "ghost" | "ghost_label";
type Counts = "length" | "obstacles" | "opponents" | "rate" | "pace" | "time" | "control_period";
type Ticks = "tick" | "newest" | "oldest" | "generation";
export interface State extends Texts<Names>, Numbers<Counts | Ticks> {
  type: "state";
  paused: boolean;
  real_time: boolean;
  edited: boolean;
  bounds: [number, number, number, number]; // m, around all that is drawn
  laps: LapRow[];
}
export interface Options extends Numbers<"undo" | "redo">, Texts<"command_line" | "yaml"> {
  type: "options";
  sections: { name: string; options: OptionDeclaration[] }[];
  changed: string[];
}
/** A message in JSON. `role` tells a page whether it drives or watches. */
export type Text =
  | Hello
  | State
  | Options
  | { type: "role"; drives: boolean }
  | { type: "error"; message: string; id?: number }
  | { type: "done"; id: number };
