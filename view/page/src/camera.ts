export type Follow = "free" | "follow" | "heading";

/** Looks at the plane from above: m of the map frame to CSS pixels of the view. */
export class Camera {
  x = 0; y = 0;
  zoom = 60; // pixels per m
  turn = 0; // rad, of the map on the screen
  follow: Follow = "follow";
  width = 1; height = 1;

  toScreen(x: number, y: number): [number, number] {
    const c = Math.cos(this.turn), s = Math.sin(this.turn), dx = x - this.x, dy = y - this.y;
    return [this.width / 2 + this.zoom * (c * dx - s * dy), this.height / 2 - this.zoom * (s * dx + c * dy)];
  }
  toMap(px: number, py: number): [number, number] {
    const c = Math.cos(this.turn), s = Math.sin(this.turn);
    const u = (px - this.width / 2) / this.zoom, v = (this.height / 2 - py) / this.zoom;
    return [this.x + c * u + s * v, this.y - s * u + c * v];
  }
  zoomAt(px: number, py: number, factor: number) {
    const [x, y] = this.toMap(px, py);
    this.zoom = Math.min(600, Math.max(4, this.zoom * factor));
    if (this.follow !== "free") return;
    const [nx, ny] = this.toMap(px, py);
    this.x += x - nx;
    this.y += y - ny;
  }
  pan(dx: number, dy: number) {
    const [x, y] = this.toMap(this.width / 2 - dx, this.height / 2 - dy);
    this.x = x;
    this.y = y;
    this.follow = "free";
  }
  /** Keeps the car in view, a little behind the middle, so that more is seen of what lies ahead. */
  track(x: number, y: number, yaw: number) {
    if (this.follow === "free") return;
    const ahead = (this.follow === "heading" ? 0.22 * this.height : 0.14 * Math.min(this.width, this.height)) / this.zoom;
    this.x = x + ahead * Math.cos(yaw);
    this.y = y + ahead * Math.sin(yaw);
    this.turn = this.follow === "heading" ? Math.PI / 2 - yaw : 0;
  }
  fit(x0: number, y0: number, x1: number, y1: number) {
    this.follow = "free";
    this.turn = 0;
    this.x = (x0 + x1) / 2;
    this.y = (y0 + y1) / 2;
    this.zoom = Math.min(this.width / (x1 - x0 + 1), this.height / (y1 - y0 + 1));
  }
}
