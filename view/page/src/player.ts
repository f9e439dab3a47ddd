import type { Handlers, Link } from "./link";
import { recordings, type Command } from "./page";
import { decode, type Frame, type State, type Text } from "./protocol";

async function unpacked(script: Element): Promise<ArrayBuffer> {
  const text = atob(script.textContent!.trim());
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) packed[i] = text.charCodeAt(i);
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}

/** A frame's figures alone: its first block. */
function scalarsOf(frame: ArrayBuffer): Float64Array {
  return new Float64Array(frame.slice(12, 12 + new DataView(frame).getUint32(8, true)));
}

/** Plays a recording: takes the place of a server, and handles the commands that concern time. */
export class Player implements Link {
  readonly waiting = 0;
  private readonly frames: ArrayBuffer[] = [];
  private readonly states: { from: number; state: State }[] = []; // each holds from this frame on
  private at = 0; // frames, with a share of the next
  private shown = -1;
  private paused = false;
  private rate = 1;
  private last = 0;
  private loading = true;

  constructor(private readonly handlers: Handlers) {
    void this.load();
    requestAnimationFrame((now) => this.turn(now));
  }

  private async load() {
    try {
      for (const script of recordings) this.take(await unpacked(script));
    } catch (error) {
      this.handlers.text({ type: "error", message: `The recording cannot be read: ${error}` });
    }
    this.loading = false;
    this.tell();
  }

  private take(bytes: ArrayBuffer) {
    const view = new DataView(bytes);
    for (let at = 0; at + 5 <= bytes.byteLength;) {
      const kind = view.getUint8(at);
      const length = view.getUint32(at + 1, true);
      const content = bytes.slice(at + 5, at + 5 + length);
      at += 5 + length;
      if (kind === 0) this.takeText(JSON.parse(new TextDecoder().decode(content)) as Text);
      else if (new DataView(content).getUint16(4, true) >= 20) this.handlers.scene(decode(content));
      else {
        this.handlers.past(scalarsOf(content), this.frames.length);
        this.frames.push(content);
      }
    }
    this.tell();
  }

  private takeText(message: Text) {
    if (message.type === "state") this.states.push({ from: this.frames.length, state: message });
    else this.handlers.text(message);
  }

  private tell() {
    const index = Math.max(0, Math.min(this.frames.length - 1, Math.floor(this.at)));
    const held = this.states.filter((s) => s.from <= index).at(-1) ?? this.states[0];
    if (!held) return;
    const now = { paused: this.paused, real_time: false, rate: this.rate, pace: 0 };
    const ticks = { tick: index, newest: this.frames.length - 1, oldest: 0 };
    this.handlers.text({ ...held.state, ...now, ...ticks });
  }

  private show() {
    const index = Math.floor(this.at);
    if (index === this.shown || !this.frames[index]) return;
    const before = this.shown;
    this.shown = index;
    this.handlers.frame(decode(this.frames[index]) as Frame, index);
    if (this.paused || index % 10 === 0 || Math.abs(index - before) > 1) this.tell();
  }

  private turn(now: number) {
    const period = this.states[0]?.state.control_period ?? 0.025;
    const passed = Math.min(1, (now - this.last) / 1000);
    this.last = now;
    if (!this.paused && this.frames.length) {
      this.at += (passed * this.rate) / period;
      if (this.at >= this.frames.length - 1) {
        this.at = this.frames.length - 1;
        if (!this.loading) {
          this.paused = true;
          this.tell();
        }
      }
    }
    this.show();
    requestAnimationFrame((then) => this.turn(then));
  }

  ask(command: Command) {
    this.send(command);
    return Promise.resolve();
  }

  drawn() {
    // Nobody waits for it: frames come from this page.
  }

  send(command: Command) {
    const end = this.frames.length - 1;
    const places: Record<string, number> = {
      play: this.at >= end ? 0 : this.at,
      pause: this.at,
      restart: 0,
      step: Math.floor(this.at) + Number(command.ticks ?? 1),
      seek: Number(command.tick),
    };
    const what = command.do as string;
    if (what in places) {
      this.at = Math.min(end, Math.max(0, places[what]));
      this.paused = what !== "play" && what !== "restart";
    } else if (what === "rate") this.rate = Number(command.rate) || 4;
    else {
      const message = "This is a recording, which cannot be changed.";
      return this.handlers.text({ type: "error", message });
    }
    this.show();
    this.tell();
  }
}
