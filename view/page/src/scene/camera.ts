export type Follow = "free" | "follow" | "heading";

/** A camera above the plane: m of the map frame to CSS pixels of the view. */
export class Camera {
  x = 0;
  y = 0;
  zoom = 60; // pixels per m
  turn = 0; // rad, of the map on the screen
  fitting = 60; // pixels per m with which all that is drawn is seen
  follow: Follow = "follow";
  width = 1;
  height = 1;
  /** The corner of the view on the stage (pixels); screen coordinates are those of the stage. */
  left = 0;
  top = 0;
  /** Pixels at the edges of the view that panels cover. The camera's point lies in the middle of the rest. */
  covered = { left: 0, right: 0, top: 0, bottom: 0 };

  private get freeWidth() {
    return Math.max(60, this.width - this.covered.left - this.covered.right);
  }
  private get freeHeight() {
    return Math.max(60, this.height - this.covered.top - this.covered.bottom);
  }
  /** The shorter side of what panels leave free, pixels. */
  get room() {
    return Math.min(this.freeWidth, this.freeHeight);
  }
  get middleX() {
    return this.left + this.covered.left + this.freeWidth / 2;
  }
  get middleY() {
    return this.top + this.covered.top + this.freeHeight / 2;
  }

  toScreen(x: number, y: number): [number, number] {
    const c = Math.cos(this.turn);
    const s = Math.sin(this.turn);
    const dx = x - this.x;
    const dy = y - this.y;
    return [this.middleX + this.zoom * (c * dx - s * dy), this.middleY - this.zoom * (s * dx + c * dy)];
  }
  toMap(px: number, py: number): [number, number] {
    const c = Math.cos(this.turn);
    const s = Math.sin(this.turn);
    const u = (px - this.middleX) / this.zoom;
    const v = (this.middleY - py) / this.zoom;
    return [this.x + c * u + s * v, this.y - s * u + c * v];
  }
  zoomAt(px: number, py: number, factor: number) {
    const [x, y] = this.toMap(px, py);
    this.zoom = Math.min(2000 * this.fitting, Math.max(this.fitting / 20, this.zoom * factor));
    if (this.follow !== "free") return;
    const [nx, ny] = this.toMap(px, py);
    this.x += x - nx;
    this.y += y - ny;
  }
  pan(dx: number, dy: number) {
    const [x, y] = this.toMap(this.middleX - dx, this.middleY - dy);
    this.x = x;
    this.y = y;
    this.follow = "free";
  }
  /** Keeps the car and the `reach` (m) of the plan ahead of it in view. */
  track(x: number, y: number, yaw: number, reach: number) {
    if (this.follow === "free") return;
    // The middle of the view is half a plan ahead of the car, as far as the car stays away from the edge.
    const room = this.follow === "heading" ? this.freeHeight : Math.min(this.freeWidth, this.freeHeight);
    const ahead = Math.min(0.5 * reach, (0.4 * room) / this.zoom);
    this.x = x + ahead * Math.cos(yaw);
    this.y = y + ahead * Math.sin(yaw);
    this.turn = this.follow === "heading" ? Math.PI / 2 - yaw : 0;
  }
  fit(x0: number, y0: number, x1: number, y1: number) {
    this.follow = "free";
    this.turn = 0;
    this.x = (x0 + x1) / 2;
    this.y = (y0 + y1) / 2;
    this.fitting = this.zoom = Math.min(this.freeWidth / (x1 - x0), this.freeHeight / (y1 - y0));
  }
}
