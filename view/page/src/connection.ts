import type { Handlers, Link } from "./link";
import { solver, type Command } from "./page";
import { decode, type Frame, type Text } from "./protocol";
import { WorkerSocket } from "./worker_socket";

/** Keeps a WebSocket open, or a worker: reconnects by itself, with a wait that grows to three seconds. */
export class Connection implements Link {
  private socket?: WebSocket | WorkerSocket;
  private attempts = 0;
  private timer = 0;
  private arrived = 0; // frames of this socket
  waiting = 0;

  constructor(private readonly handlers: Handlers) {
    this.open();
  }

  get connected() {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  send(command: Command) {
    if (this.connected) this.socket!.send(JSON.stringify(command));
  }

  ask(command: Command): Promise<void> {
    if (!this.connected) return Promise.reject(new Error("There is no connection to the server."));
    const id = ++this.asked;
    return new Promise((done, fail) => {
      this.questions.set(id, { done, fail });
      this.send({ ...command, id });
    });
  }
  private asked = 0;
  private readonly questions = new Map<number, { done(): void; fail(error: Error): void }>();

  /** Whether a message answers a command; the asker deals with it then. */
  private answers(message: Text) {
    if (message.type !== "done" && message.type !== "error") return false;
    const question = this.questions.get(message.id ?? 0);
    this.questions.delete(message.id ?? 0);
    if (message.type === "done") question?.done();
    else question?.fail(new Error(message.message));
    return question !== undefined;
  }

  /** Acknowledges the frames: the server has at most two under way that are not acknowledged. */
  drawn() {
    if (!this.connected || this.waiting === 0) return;
    this.waiting = 0;
    const message = new DataView(new ArrayBuffer(4));
    message.setUint32(0, this.arrived, true);
    this.socket!.send(message);
  }

  private open() {
    const address = new URL("ws", location.href);
    address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    address.hash = "";
    const token = new URLSearchParams(location.search).get("token");
    address.search = "?acknowledge=1" + (token ? "&token=" + encodeURIComponent(token) : "");
    const socket = solver ? new WorkerSocket(solver) : new WebSocket(address);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onopen = () => {
      this.attempts = 0;
      this.arrived = this.waiting = 0;
      this.handlers.status(true, 0);
    };
    socket.onmessage = (event: { data: string | ArrayBuffer }) => this.got(event.data);
    socket.onclose = () => {
      this.attempts += 1;
      for (const { fail } of this.questions.values()) fail(new Error("The connection was lost."));
      this.questions.clear();
      this.handlers.status(false, this.attempts);
      clearTimeout(this.timer);
      this.timer = window.setTimeout(() => this.open(), Math.min(3000, 250 * this.attempts));
    };
  }

  private got(data: string | ArrayBuffer) {
    if (typeof data === "string") {
      const text = JSON.parse(data) as Text;
      if (!this.answers(text)) this.handlers.text(text);
      return;
    }
    const message = decode(data);
    if (message.file) this.handlers.file(message.file.name, message.file.content);
    else if (message.past) this.handlers.past(message.past);
    else if (message.grid) this.handlers.scene(message);
    else if (message.scalars) {
      this.arrived += 1;
      this.waiting += 1;
      this.handlers.frame(message as Frame);
    }
  }
}
