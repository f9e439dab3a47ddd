import { isIntroduction, recordings } from "./page";
import type { State, Text } from "./protocol";

async function unpacked(script: Element): Promise<ArrayBuffer> {
  const text = atob(script.textContent!.trim());
  const packed = Uint8Array.from(text, (c) => c.charCodeAt(0));
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}

const head = 12; // bytes of a message before the payload of its first block
/** The scalars of a frame, its first block. */
const scalarsOf = (frame: ArrayBuffer) =>
  new Uint8Array(frame, head, new DataView(frame).getUint32(head - 4, true));
const pastScalars = 22; // kind of block

/** Plays a recording: takes the place of a connection, and handles the commands that concern time. */
export class Player {
  readyState: number = WebSocket.CONNECTING;
  binaryType = "arraybuffer";
  onopen?: () => void;
  onmessage?: (event: { data: string | ArrayBuffer }) => void;
  onclose?: () => void;
  private readonly frames: ArrayBuffer[] = [];
  private readonly states: { from: number; state: State }[] = []; // each holds from this frame on
  private at = 0; // frames, with a share of the next
  private shown = -1;
  private paused = false;
  private rate = 1;
  private last = 0; // ms, time of the last turn
  private loading = true;

  constructor() {
    void this.load();
    requestAnimationFrame((now) => this.turn(now));
  }

  private async load() {
    try {
      for (const script of recordings) this.take(await unpacked(script));
    } catch (error) {
      this.say({ type: "error", message: `The recording cannot be read: ${error}` });
    }
    this.loading = false;
    if (isIntroduction) [this.at, this.paused, this.rate] = [0, true, 0.1];
    this.tell();
  }

  /** Takes messages, each behind its kind (0: text) and length. Frames are counted in place of ticks. */
  private take(bytes: ArrayBuffer) {
    this.readyState = WebSocket.OPEN;
    const view = new DataView(bytes);
    for (let at = 0; at + 5 <= bytes.byteLength;) {
      const kind = view.getUint8(at);
      const length = view.getUint32(at + 1, true);
      const content = bytes.slice(at + 5, at + 5 + length);
      at += 5 + length;
      if (kind === 0) this.takeText(JSON.parse(new TextDecoder().decode(content)) as Text);
      else if (new DataView(content).getUint16(4, true) >= 20) this.onmessage!({ data: content });
      else {
        new DataView(content).setFloat64(head, this.frames.length, true);
        this.frames.push(content);
      }
    }
    this.tell();
  }

  private takeText(message: Text) {
    if (message.type === "state") this.states.push({ from: this.frames.length, state: message });
    else this.say(message);
  }

  private say(message: Text) {
    this.onmessage!({ data: JSON.stringify(message) });
  }

  private tell() {
    const index = Math.max(0, Math.min(this.frames.length - 1, Math.floor(this.at)));
    const held = this.states.filter((s) => s.from <= index).at(-1) ?? this.states[0];
    if (!held) return;
    const now = { paused: this.paused, real_time: false, rate: this.rate, pace: 0 };
    const ticks = { tick: index, newest: this.frames.length - 1, oldest: 0 };
    this.say({ ...held.state, ...now, ...ticks });
  }

  private show() {
    const index = Math.floor(this.at);
    if (index === this.shown || !this.frames[index]) return;
    const before = this.shown;
    this.shown = index;
    this.onmessage!({ data: this.frames[index] });
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

  send(data: string | DataView) {
    if (typeof data !== "string") return; // nobody waits for what is drawn
    const command = JSON.parse(data) as Record<string, number> & { do: string };
    const end = this.frames.length - 1;
    const places: Record<string, number> = {
      play: this.at >= end ? 0 : this.at,
      pause: this.at,
      restart: 0,
      step: Math.floor(this.at) + (command.ticks ?? 1),
      seek: command.tick,
    };
    if (command.do === "past") return this.sendPast(command.from, command.to);
    if (command.do in places) {
      this.at = Math.min(end, Math.max(0, places[command.do]));
      this.paused = command.do !== "play" && command.do !== "restart";
    } else if (command.do === "rate") this.rate = command.rate || 4;
    else {
      const message = "This is a recording, which cannot be changed.";
      return this.say({ type: "error", message, id: command.id });
    }
    if (command.id) this.say({ type: "done", id: command.id });
    this.show();
    this.tell();
  }

  /** Sends the scalars of some frames. */
  private sendPast(from: number, to: number) {
    const rows = this.frames.slice(from, to + 1).map(scalarsOf);
    const length = rows.reduce((sum, row) => sum + row.length, 0);
    const message = new Uint8Array(head + length);
    message.set(new Uint8Array(this.frames[0], 0, 4));
    new DataView(message.buffer).setUint16(4, pastScalars, true);
    new DataView(message.buffer).setUint32(8, length, true);
    rows.forEach((row, i) => message.set(row, head + i * row.length));
    this.onmessage!({ data: message.buffer });
  }
}
