/** A point or direction in space, m: x and y of the map frame, z upwards. */
export type Vector = [number, number, number];

const fieldOfView = 0.9; // rad, of the shorter side of the picture
const near = 0.05; // m

/** A camera on a sphere around a point. */
export class Orbit {
  target: Vector = [0, 0, 0];
  distance = 4.2; // m
  pitch = 0.42; // rad above the horizon
  azimuth = 0; // rad, where the camera looks; from the heading of the car while it follows that
  heading = 0; // rad
  width = 1; height = 1; // pixels
  /** Pixels by which the target lies beside the middle of the picture. */
  aside: [number, number] = [0, 0];
  /** Width and height that panels leave free (pixels). */
  free: [number, number] = [1, 1];

  /** What makes the view, as a text to compare. */
  place() { return [...this.target, this.azimuth, this.pitch, this.distance].join(); }

  turn(dx: number, dy: number) {
    this.azimuth -= 0.006 * dx;
    this.pitch = Math.min(1.55, Math.max(0.06, this.pitch + 0.006 * dy));
  }
  zoom(factor: number) { this.distance = Math.min(200, Math.max(1, this.distance / factor)); }

  private get forward(): Vector {
    const a = this.heading + this.azimuth, c = Math.cos(this.pitch);
    return [c * Math.cos(a), c * Math.sin(a), -Math.sin(this.pitch)];
  }
  private get right(): Vector { const a = this.heading + this.azimuth; return [Math.sin(a), -Math.cos(a), 0]; }
  private get up(): Vector {
    const [rx, ry] = this.right, [fx, fy, fz] = this.forward;
    return [ry * fz, -rx * fz, rx * fy - ry * fx];
  }
  get eye(): Vector { const f = this.forward; return this.target.map((v, i) => v - this.distance * f[i]) as Vector; }
  private get focal() { return 0.5 * Math.min(this.width, this.height) / Math.tan(fieldOfView / 2); } // pixels

  /** Column by column, for positions relative to the target. */
  matrix(): Float32Array {
    const r = this.right, u = this.up, f = this.forward, sx = (2 * this.focal) / this.width, sy = (2 * this.focal) / this.height;
    const [ax, ay] = [(2 * this.aside[0]) / this.width, (-2 * this.aside[1]) / this.height], m = new Float32Array(16);
    for (let i = 0; i < 3; ++i) {
      m[4 * i] = sx * r[i] + ax * f[i];
      m[4 * i + 1] = sy * u[i] + ay * f[i];
      m[4 * i + 2] = f[i];
      m[4 * i + 3] = f[i];
    }
    // The far plane is at infinity, where z / w approaches 1.
    m.set([ax * this.distance, ay * this.distance, this.distance - 2 * near, this.distance], 12);
    return m;
  }

  /** Where a place is seen (pixels), or undefined if it is behind the camera. */
  toScreen(x: number, y: number, z = 0): [number, number] | undefined {
    const m = this.matrix(), p = [x - this.target[0], y - this.target[1], z - this.target[2], 1];
    const at = (row: number) => p.reduce((sum, v, i) => sum + v * m[4 * i + row], 0), w = at(3);
    return w > near ? [(0.5 + (0.5 * at(0)) / w) * this.width, (0.5 - (0.5 * at(1)) / w) * this.height] : undefined;
  }

  /** The place on the ground that is seen at a pixel; far away where that is the sky. */
  toGround(px: number, py: number): [number, number] {
    const u = (px - this.width / 2 - this.aside[0]) / this.focal, v = (this.height / 2 + this.aside[1] - py) / this.focal;
    const r = this.right, up = this.up, f = this.forward, e = this.eye, d = f.map((each, i) => each + u * r[i] + v * up[i]);
    const reach = d[2] < -1e-3 ? -e[2] / d[2] : 1000;
    return [e[0] + reach * d[0], e[1] + reach * d[1]];
  }

  /** Shows a rectangle of the ground, m. */
  fit(x0: number, y0: number, x1: number, y1: number) {
    this.target = [(x0 + x1) / 2, (y0 + y1) / 2, 0];
    this.azimuth = Math.PI / 2;
    this.heading = 0;
    this.pitch = 0.95;
    const shorter = Math.min(this.width, this.height), wide = (x1 - x0) / this.free[0], deep = (y1 - y0) / this.free[1];
    this.distance = (0.56 * shorter * Math.max(wide, deep)) / Math.tan(fieldOfView / 2);
  }
}
