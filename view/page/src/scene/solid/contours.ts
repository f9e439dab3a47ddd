import type { Grid } from "../../protocol";

/** The mean over 3 x 3 cells, so that the border between free and occupied is drawn as a line and not as stairs. */
export function smoothed(cells: Uint8Array, width: number, height: number): Uint8Array {
  const rows = new Uint16Array(cells.length), out = new Uint8Array(cells.length);
  for (let i = 1; i + 1 < cells.length; ++i) rows[i] = cells[i - 1] + cells[i] + cells[i + 1];
  for (let i = width; i < width * (height - 1); ++i) out[i] = Math.round((rows[i - width] + rows[i] + rows[i + width]) / 9);
  return out;
}

/** The free cells of a grid as 255, all others as 0, smoothed. */
export function freeSpace(grid: Grid): Uint8Array {
  return smoothed(grid.cells.map((v) => (v === 0 ? 255 : 0)), grid.width, grid.height);
}

const level = 127.5;
/** The sides of a square between four cells that its piece of the border joins: 0 lower, 1 right, 2 upper, 3 left. */
const joined = [[], [3, 0], [0, 1], [3, 1], [1, 2], [3, 0, 1, 2], [0, 2], [3, 2], [2, 3], [2, 0], [0, 1, 2, 3], [2, 1], [1, 3], [1, 0], [0, 3], []];

/**
 * The border of the free space as segments x0, y0, x1, y1 (m, map frame), by marching squares.
 */
export function border(grid: Grid, free: Uint8Array): Float32Array {
  const { width, height, resolution, x, y, yaw } = grid, c = Math.cos(yaw), s = Math.sin(yaw);
  let out: Float32Array = new Float32Array(4096), n = 0;
  const put = (u: number, v: number) => {
    if (n + 2 > out.length) { const larger = new Float32Array(2 * out.length); larger.set(out); out = larger; }
    const a = (u + 0.5) * resolution, b = (v + 0.5) * resolution;
    out[n++] = x + c * a - s * b;
    out[n++] = y + s * a + c * b;
  };
  for (let j = 0; j + 1 < height; ++j) {
    for (let i = 0; i + 1 < width; ++i) {
      const at = j * width + i, corner = (k: number) => free[at + [0, 1, width + 1, width][k % 4]];
      const bits = +(free[at] > level) | (+(free[at + 1] > level) << 1) | (+(free[at + width + 1] > level) << 2) | (+(free[at + width] > level) << 3);
      for (const side of joined[bits]) {
        const a = corner(side), t = (level - a) / (corner(side + 1) - a);
        if (side === 0) put(i + t, j);
        else if (side === 1) put(i + 1, j + t);
        else if (side === 2) put(i + 1 - t, j + 1);
        else put(i, j + 1 - t);
      }
    }
  }
  return out.subarray(0, n);
}
