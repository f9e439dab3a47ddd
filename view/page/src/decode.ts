import type { Body, Frame, Other, PlanState, Scene } from "./protocol";

const magic = 0x31564c53; // "SLV1"
const firstOfScene = 20; // kinds of blocks from this one on are not those of a frame

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
  f32s = (n: number) => Float32Array.from({ length: n }, this.f32);
  u8s = (n: number) => Uint8Array.from({ length: n }, this.u8);
  f64s = () => Float64Array.from({ length: (this.end - this.at) / 8 }, this.f64);
  pose = () => ({ x: this.f64(), y: this.f64(), yaw: this.f64() });
  align = () => (this.at = (this.at + 3) & ~3);

  /** Points as an origin, a unit and differences of 16 bits. */
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

/** Reads the block of a frame of each kind. */
const frameBlocks: Record<number, (r: Reader, frame: Frame) => void> = {
  1: (r, frame) => (frame.scalars = r.f64s()),
  2: (r, frame) => {
    const pose = r.pose();
    frame.scan = { ...pose, ranges: Uint16Array.from({ length: r.u32() }, r.u16) };
  },
  3: (r, frame) => {
    const pose = r.pose();
    const [rows, columns] = [r.u16(), r.u16()];
    const [resolution, centerX, centerY] = r.f32s(3);
    const bits = r.u8s(Math.ceil((rows * columns) / 8));
    const cells = Uint8Array.from({ length: rows * columns }, (_, i) =>
      bits[i >> 3] & (1 << (i & 7)) ? 255 : 0,
    );
    frame.costMap = { ...pose, rows, columns, resolution, centerX, centerY, cells };
  },
  4: (r, frame) => {
    const [count, points] = [r.u16(), r.u16()];
    const terms = r.f32s(count * 5);
    const collided = r.u8s(count);
    r.align();
    frame.candidates = { count, points, terms, collided, xy: r.points(count * points) };
  },
  5: (r, frame) => {
    const [guides, iterations, points] = [r.u16(), r.u16(), r.u16(), r.u16()];
    const count = guides * iterations;
    frame.guides = { guides, iterations, count, points, xy: r.points(count * points) };
  },
  6: (r, frame) => {
    const points = r.u32();
    frame.nominal = { count: 1, points, xy: r.points(points) };
  },
  7: (r, frame) => {
    const [n, x0, y0] = [r.u32(), r.f64(), r.f64()];
    frame.plan = Array.from({ length: n }, (): PlanState => {
      const [x, y, yaw, speed, steer, spread] = r.f32s(6);
      return { x: x0 + x, y: y0 + y, yaw, speed, steer, spread };
    });
  },
  8: (r, frame) => {
    frame.bodies = Array.from({ length: r.u32() }, (): Body => {
      const [id, kind, touched] = [r.u16(), r.u8(), r.u8() !== 0];
      const [x, y, yaw, length, width] = r.f32s(5);
      return { id, kind, touched, x, y, yaw, length, width };
    });
  },
  9: (r, frame) => (frame.covariance = r.f32s((r.end - r.at) / 4)),
  10: (r, frame) => {
    const pose = r.pose();
    const [steer, speed, laps, lapTime] = [r.f64(), r.f64(), r.f64(), r.f64()];
    frame.ghost = { ...pose, steer, speed, laps, lapTime, plan: r.points(r.u32()) };
  },
  12: (r, frame) => {
    frame.others = Array.from({ length: r.u32() }, (): Other => {
      const [length, width, yaw] = r.f32s(3);
      const [count, points] = [r.u16(), r.u16()];
      const weights = r.f32s(count);
      const xy = r.points(count * points);
      return { x: xy[0], y: xy[1], yaw, length, width, weights, points, xy };
    });
  },
};

/** Reads the block of a scene of each kind. */
const sceneBlocks: Record<number, (r: Reader, scene: Scene) => void> = {
  20: (r, scene) => {
    const [width, height, resolution] = [r.u32(), r.u32(), r.f64()];
    const grid = { width, height, resolution, ...r.pose(), cells: new Uint8Array(width * height) };
    let to = 0;
    for (let runs = r.u32(); runs > 0; --runs) {
      const run = r.u32();
      const many = run & 0xffffff;
      grid.cells.fill(run >>> 24, to, to + many);
      to += many;
    }
    scene.grid = grid;
  },
  21: (r, scene) => {
    const [n, closed] = [r.u32(), r.u32() !== 0];
    scene.path = { closed, xyv: r.f32s(3 * n) };
  },
};

export interface Message {
  frame?: Frame;
  scene?: Scene;
  past?: Float64Array; // the scalars of past steps
  file?: { name: string; content: Uint8Array };
}

/** Reads a binary message. Blocks of an unknown kind are of a later version and skipped. */
export function decode(buffer: ArrayBuffer): Message {
  const view = new DataView(buffer);
  if (view.byteLength < 4 || view.getUint32(0, true) !== magic)
    throw new Error("not a message of the live view");
  const frame: Frame = { scalars: new Float64Array(0), bodies: [] };
  const scene: Scene = {};
  let isScene = false;
  for (let at = 4; at + 8 <= view.byteLength;) {
    const kind = view.getUint16(at, true);
    const length = view.getUint32(at + 4, true);
    const r = new Reader(view, at + 8, Math.min(at + 8 + length, view.byteLength));
    at += 8 + ((length + 3) & ~3);
    isScene ||= kind >= firstOfScene;
    if (kind === 11) frame.ghostFrame = decode(buffer.slice(r.at, r.end)).frame;
    else if (kind === 22) return { past: r.f64s() };
    else if (kind === 30) {
      const name = new TextDecoder().decode(r.u8s(r.u32()));
      r.align();
      return { file: { name, content: new Uint8Array(buffer, r.at, r.end - r.at) } };
    } else {
      frameBlocks[kind]?.(r, frame);
      sceneBlocks[kind]?.(r, scene);
    }
  }
  return isScene ? { scene } : { frame };
}
