import { Camera } from "./camera";

const room = { top: 40, bottom: 56 }; // pixels of a lane that its title and caption cover

/** The stage with its cameras: one for the whole stage, or one for the car's lane and one for the ghost's. */
export class Stage {
  readonly camera = new Camera();
  readonly ghostCamera = new Camera();
  private size = { width: 1, height: 1, covered: this.camera.covered };

  /** Sets the size of the stage and what panels cover of it (pixels). */
  resize(width: number, height: number, covered: Camera["covered"]) {
    this.size = { width, height, covered };
  }

  /** Lets the car's camera see the whole stage. */
  joinLanes() {
    Object.assign(this.camera, { left: 0, top: 0, ...this.size });
  }

  /** Puts the lanes beside one another, or one above the other on a high stage. */
  splitLanes() {
    const { width, height, covered } = this.size;
    if (width >= 0.7 * height) {
      const middle = Math.round((covered.left + width - covered.right) / 2);
      const own = { top: 0, height };
      const free = { top: covered.top + room.top, bottom: room.bottom, left: 0, right: 0 };
      Object.assign(this.camera, own, { left: 0, width: middle, covered: { ...free, left: covered.left } });
      const second = { left: middle, width: width - middle, covered: { ...free, right: covered.right } };
      Object.assign(this.ghostCamera, own, second);
    } else {
      const middle = Math.round((covered.top + height) / 2);
      const own = { left: 0, width };
      const free = { left: covered.left, right: covered.right, ...room };
      const first = { top: 0, height: middle, covered: { ...free, top: covered.top + room.top } };
      Object.assign(this.camera, own, first);
      Object.assign(this.ghostCamera, own, { top: middle, height: height - middle, covered: free });
    }
    const { x, y, zoom, turn, follow } = this.camera;
    Object.assign(this.ghostCamera, { zoom, turn, follow }, follow === "free" ? { x, y } : {});
  }

  /** Whether a point of the stage lies in the ghost's lane, while the lanes are split. */
  isInGhostLane(p: { x: number; y: number }) {
    return p.x >= this.ghostCamera.left && p.y >= this.ghostCamera.top;
  }

  /** The point of the car's lane that shows the same place as a point of the ghost's lane. */
  fromGhostLane(p: { x: number; y: number }) {
    const [x, y] = this.camera.toScreen(...this.ghostCamera.toMap(p.x, p.y));
    return { x, y };
  }
}
