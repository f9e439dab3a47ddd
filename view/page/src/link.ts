import type { Frame, Scene, Text } from "./protocol";

/** Who gets what comes, from a server or from a recording. */
export interface Handlers {
  frame(frame: Frame): void;
  scene(scene: Scene): void;
  /** The figures of the frames before one that was jumped to. */
  past(scalars: Float64Array[]): void;
  text(message: Text): void;
  file(name: string, content: Uint8Array): void;
  status(connected: boolean, attempts: number): void;
}

/** Where the page gets its messages from and sends its commands to. */
export interface Link {
  send(command: Record<string, unknown>): void;
  /** Tells that what was received has been drawn. */
  drawn(): void;
  readonly received: number; // frames
  readonly waiting: number; // frames received and not yet drawn
}
