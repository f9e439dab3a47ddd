import { page } from "./page";
import type { Frame, Text } from "./protocol";

// The messages of servers that tell a car and a problem in two ways.

/* eslint-disable @typescript-eslint/no-explicit-any */
let isCar = false;

/** A text message as all drives have it. */
export function toText(message: any): Text {
  if (message.type === "hello" && !message.can) {
    const { problem, car } = message;
    isCar = !problem;
    message.title ??= problem?.title ?? "";
    message.states ??= problem?.states ?? [];
    message.inputs ??= problem?.inputs ?? ["steering, rad", "acceleration, m/s^2"];
    message.terms ??= ["distance", "yaw", "collision"];
    message.body = car ?? { ...problem, front: 0, rear: 0 };
    const words = { place: problem?.can_place, move: problem?.can_move };
    const some = Object.entries(words).flatMap(([word, is]) => (is ? [word] : []));
    message.can = isCar ? ["place", "move", "add", "scenario", "real_time", "save", "ghost", "undo"] : some;
    message.scalars = message.scalars.map((name: string) =>
      name === "sequence_cost" ? "plan_cost" : name.replace(/^cost\.(.*)$/, "$1_cost"),
    );
  }
  if (message.type === "state" && !message.bounds) {
    const xyv: Float32Array = page.scene?.path?.xyv ?? new Float32Array(6);
    const axes = [0, 1].map((k) => xyv.filter((_, i) => i % 3 === k));
    const ends = [Math.min, Math.max].flatMap((end) => axes.map((all) => end(...all)));
    message.bounds = ends;
  }
  return message as Text;
}

/** A frame as all drives have it. */
export function toFrame(frame: Frame): Frame {
  if (isCar && frame.candidates)
    frame.candidates.collided = frame.candidates.collided.map((v) => (v === 1 ? 255 : v));
  return frame;
}
