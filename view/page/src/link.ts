import type { Command } from "./page";
import type { Frame, Scene, Text } from "./protocol";

/** Who gets what comes, from a server or from a recording. */
export interface Handlers {
  /** `position`: in the past, if it is not the tick. */
  frame(frame: Frame, position?: number): void;
  scene(scene: Scene): void;
  /** The scalars of several steps in a row; `from`: the position of the first if they are not live. */
  past(scalars: Float64Array, from?: number): void;
  text(message: Text): void;
  file(name: string, content: Uint8Array): void;
  status(connected: boolean, attempts: number): void;
}

/** Where the page gets its messages from and sends its commands to. */
export interface Link {
  send(command: Command): void;
  ask(command: Command): Promise<void>;
  /** Tells that what was received has been drawn. */
  drawn(): void;
  readonly waiting: number; // frames received and not yet drawn
}
