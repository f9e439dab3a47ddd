// The messages of the live view; docs/live-view.md describes them.

export type Vec = Float32Array;

/** Poses in m, m, rad, map frame. */
export interface Trajectories {
  count: number;
  points: number; // per trajectory
  xy: Float32Array; // [trajectory][point][2], m, map frame
}
export interface Candidates extends Trajectories {
  terms: Float32Array; // [trajectory][distance, yaw, collision, solver's cost, weight]
  collided: Uint8Array;
}
export interface Guides extends Trajectories {
  guides: number;
  iterations: number; // trajectories are [iteration][guide]; the last iteration is where they ended
}
export interface PlanState {
  x: number; y: number; yaw: number; speed: number; steer: number; spread: number;
}
export interface Body {
  id: number; kind: number; touched: boolean; x: number; y: number; yaw: number; length: number; width: number;
}
export interface Scan { x: number; y: number; yaw: number; ranges: Uint16Array }
export interface CostMap {
  x: number; y: number; yaw: number; rows: number; columns: number; resolution: number;
  centerX: number; centerY: number; cells: Uint8Array;
}
/** A car that is tracked: its box now, and where it is expected. */
export interface Other { x: number; y: number; yaw: number; length: number; width: number; weights: Float32Array; points: number; xy: Float32Array } // xy: [hypothesis][time][2]
export interface Ghost { x: number; y: number; yaw: number; steer: number; speed: number; laps: number; lapTime: number; plan: Float32Array }
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
  ghostFrame?: Frame; // what the ghost's controller considers, in the ghost's world
}
export interface Grid { width: number; height: number; resolution: number; x: number; y: number; yaw: number; cells: Uint8Array }
export interface Path { closed: boolean; xyv: Float32Array }
export interface Scene { grid?: Grid; path?: Path }

const MAGIC = 0x31564c53; // "SLV1"
const kinds = { scalars: 1, scan: 2, costMap: 3, candidates: 4, guides: 5, nominal: 6, plan: 7, bodies: 8, covariance: 9, ghost: 10, ghostFrame: 11, others: 12, grid: 20, path: 21, past: 22, file: 30 };

class Reader {
  at: number;
  constructor(readonly view: DataView, at: number, readonly end: number) { this.at = at; }
  need(bytes: number) { if (this.at + bytes > this.end) throw new Error("a block is too short"); }
  u8() { this.need(1); return this.view.getUint8(this.at++); }
  u16() { this.need(2); const v = this.view.getUint16(this.at, true); this.at += 2; return v; }
  u32() { this.need(4); const v = this.view.getUint32(this.at, true); this.at += 4; return v; }
  i16() { this.need(2); const v = this.view.getInt16(this.at, true); this.at += 2; return v; }
  f32() { this.need(4); const v = this.view.getFloat32(this.at, true); this.at += 4; return v; }
  f64() { this.need(8); const v = this.view.getFloat64(this.at, true); this.at += 8; return v; }
  f32s(n: number) { const out = new Float32Array(n); for (let i = 0; i < n; ++i) out[i] = this.f32(); return out; }
}

function points(r: Reader, count: number): Float32Array {
  const x = r.f64(), y = r.f64(), unit = r.f32();
  const out = new Float32Array(count * 2);
  let u = 0, v = 0;
  for (let i = 0; i < count; ++i) {
    u = ((u + r.i16()) << 16) >> 16;
    v = ((v + r.i16()) << 16) >> 16;
    out[2 * i] = x + unit * u;
    out[2 * i + 1] = y + unit * v;
  }
  return out;
}

/** Reads a binary message: a frame, a scene (grid and path), scalars of past steps, or a file. */
export function decode(buffer: ArrayBuffer): { frame?: Frame; scene?: Scene; past?: Float64Array; file?: { name: string; content: Uint8Array } } {
  const view = new DataView(buffer);
  if (view.byteLength < 4 || view.getUint32(0, true) !== MAGIC) throw new Error("not a message of the live view");
  const frame: Frame = { scalars: new Float64Array(0), bodies: [] };
  const scene: Scene = {};
  let isScene = false;
  let at = 4;
  while (at + 8 <= view.byteLength) {
    const kind = view.getUint16(at, true), length = view.getUint32(at + 4, true);
    const r = new Reader(view, at + 8, Math.min(at + 8 + length, view.byteLength));
    at += 8 + ((length + 3) & ~3);
    switch (kind) {
      case kinds.scalars: {
        const n = length / 8;
        frame.scalars = new Float64Array(n);
        for (let i = 0; i < n; ++i) frame.scalars[i] = r.f64();
        break;
      }
      case kinds.scan: {
        const x = r.f64(), y = r.f64(), yaw = r.f64(), n = r.u32();
        const ranges = new Uint16Array(n);
        for (let i = 0; i < n; ++i) ranges[i] = r.u16();
        frame.scan = { x, y, yaw, ranges };
        break;
      }
      case kinds.costMap: {
        const x = r.f64(), y = r.f64(), yaw = r.f64(), rows = r.u16(), columns = r.u16();
        const resolution = r.f32(), centerX = r.f32(), centerY = r.f32();
        const cells = new Uint8Array(rows * columns);
        for (let i = 0; i < cells.length; i += 8) {
          const bits = r.u8();
          for (let b = 0; b < 8 && i + b < cells.length; ++b) cells[i + b] = bits & (1 << b) ? 255 : 0;
        }
        frame.costMap = { x, y, yaw, rows, columns, resolution, centerX, centerY, cells };
        break;
      }
      case kinds.candidates: {
        const count = r.u16(), n = r.u16();
        const terms = r.f32s(count * 5);
        const collided = new Uint8Array(count);
        for (let i = 0; i < count; ++i) collided[i] = r.u8();
        r.at = (r.at + 3) & ~3;
        frame.candidates = { count, points: n, terms, collided, xy: points(r, count * n) };
        break;
      }
      case kinds.guides: {
        const guides = r.u16(), iterations = r.u16(), n = r.u16();
        r.u16();
        const count = guides * iterations;
        frame.guides = { guides, iterations, count, points: n, xy: points(r, count * n) };
        break;
      }
      case kinds.nominal: {
        const n = r.u32();
        frame.nominal = { count: 1, points: n, xy: points(r, n) };
        break;
      }
      case kinds.plan: {
        const n = r.u32();
        const x = r.f64(), y = r.f64();
        frame.plan = [];
        for (let i = 0; i < n; ++i) {
          const v = r.f32s(6);
          frame.plan.push({ x: x + v[0], y: y + v[1], yaw: v[2], speed: v[3], steer: v[4], spread: v[5] });
        }
        break;
      }
      case kinds.bodies: {
        const n = r.u32();
        for (let i = 0; i < n; ++i) {
          const id = r.u16(), bodyKind = r.u8(), touched = r.u8() !== 0, v = r.f32s(5);
          frame.bodies.push({ id, kind: bodyKind, touched, x: v[0], y: v[1], yaw: v[2], length: v[3], width: v[4] });
        }
        break;
      }
      case kinds.others: {
        frame.others = [];
        for (let left = r.u32(); left > 0; --left) {
          const [length, width, yaw] = r.f32s(3), count = r.u16(), n = r.u16(), weights = r.f32s(count), xy = points(r, count * n);
          frame.others.push({ x: xy[0], y: xy[1], yaw, length, width, weights, points: n, xy });
        }
        break;
      }
      case kinds.covariance:
        frame.covariance = r.f32s(length / 4);
        break;
      case kinds.ghost: {
        const x = r.f64(), y = r.f64(), yaw = r.f64(), steer = r.f64(), speed = r.f64(), laps = r.f64(), lapTime = r.f64();
        const n = r.u32();
        frame.ghost = { x, y, yaw, steer, speed, laps, lapTime, plan: points(r, n) };
        break;
      }
      case kinds.ghostFrame:
        frame.ghostFrame = decode(buffer.slice(r.at, r.end)).frame;
        break;
      case kinds.grid: {
        const width = r.u32(), height = r.u32(), resolution = r.f64(), x = r.f64(), y = r.f64(), yaw = r.f64();
        const cells = new Uint8Array(width * height), runs = r.u32();
        let to = 0;
        for (let i = 0; i < runs; ++i) {
          const run = r.u32(), many = run & 0xffffff;
          cells.fill(run >>> 24, to, to + many);
          to += many;
        }
        scene.grid = { width, height, resolution, x, y, yaw, cells };
        isScene = true;
        break;
      }
      case kinds.file: {
        const n = r.u32(), begin = r.at + ((n + 3) & ~3);
        return { file: { name: new TextDecoder().decode(new Uint8Array(buffer, r.at, n)), content: new Uint8Array(buffer, begin, r.end - begin) } };
      }
      case kinds.past: {
        const past = new Float64Array(length / 8);
        for (let i = 0; i < past.length; ++i) past[i] = r.f64();
        return { past };
      }
      case kinds.path: {
        const n = r.u32(), closed = r.u32() !== 0;
        scene.path = { closed, xyv: r.f32s(3 * n) };
        isScene = true;
        break;
      }
      default: // of a later version
    }
  }
  return isScene ? { scene } : { frame };
}

export interface OptionDeclaration {
  name: string; symbol: string; unit: string; help: string;
  type: "flag" | "integer" | "count" | "number" | "numbers" | "choice";
  min?: number; max?: number; choices?: string[]; value: string; default: string;
}
export interface OptionSection { name: string; options: OptionDeclaration[] }
export interface Hello {
  type: "hello"; protocol: number; scalars: string[]; statuses: string[]; courses: string[]; methods: string[]; configurations: string[];
  car: { length: number; width: number; front: number; rear: number };
  lidar: { angle_min: number; angle_increment: number; range_max: number };
  session: string; history_seconds: number; control_period: number; replay?: boolean;
}
export interface LapRow { lap: number; time: number; contacts: number; method: string; ghost?: boolean }
export interface State {
  type: "state"; course: string; description: string; length: number; method: string; config: string; evaluation: string;
  seed: string; obstacles: number; opponents: number; paused: boolean; real_time: boolean; rate: number; tick: number; newest: number; oldest: number;
  time: number; control_period: number; laps: LapRow[]; ghost: string; ghost_label: string; contact?: { experiment: number; lap: number; contact: number; tick: number }; generation: number; clients: number; edited: boolean; introduction?: boolean;
}
export interface Options { type: "options"; sections: OptionSection[]; changed: string[]; command_line: string; yaml: string; undo: number; redo: number }
export interface Problem { type: "error"; message: string; id?: number }
export interface Done { type: "done"; id: number }
export interface Note { type: "note"; message: string }
export interface EvaluationLap { experiment: number; lap: number; seed: string; finished: boolean; time: number; contacts: number; points: [number, number][] }
export interface Evaluation { type: "evaluation"; folder: string; course: string; experiments: { label: string; scenario: string; obstacles: number }[]; laps: EvaluationLap[] }
export type Text = Hello | State | Options | Problem | Done | Note | Evaluation;
