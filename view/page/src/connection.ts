import { page, solver, tell, isReplay } from "./page";
import { Player } from "./player";
import { decode, type Frame, type Text } from "./protocol";
import { WorkerSocket } from "./worker_socket";

export type Command = Record<string, unknown>;

let socket: WebSocket | WorkerSocket | Player | undefined;
let attempts = 0; // to connect, in vain
let timer = 0;
let arrived = 0; // frames of this socket
/** Frames that have come and are not drawn. */
export let waiting = 0;
let asked = 0;
const questions = new Map<number, { done(): void; fail(error: Error): void }>();

const isOpen = () => socket?.readyState === WebSocket.OPEN;

/** Sends a command to the server. */
export function send(command: Command) {
  if (isOpen()) socket!.send(JSON.stringify(command));
}

/** Sends a command and waits until it was executed; fails with the reason why it could not be. */
export function ask(command: Command): Promise<void> {
  if (!isOpen()) return Promise.reject(new Error("There is no connection to the server."));
  const id = ++asked;
  return new Promise((done, fail) => {
    questions.set(id, { done, fail });
    send({ ...command, id });
  });
}

/** Tells that the frames are drawn: the server has at most two under way that are not acknowledged. */
export function acknowledge() {
  if (!isOpen() || waiting === 0) return;
  waiting = 0;
  const message = new DataView(new ArrayBuffer(4));
  message.setUint32(0, arrived, true);
  socket!.send(message);
}

/** Keeps a connection open: reconnects by itself, with a wait that grows to three seconds. */
export function connect() {
  const address = new URL("ws", location.href);
  address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
  address.hash = "";
  const token = new URLSearchParams(location.search).get("token");
  address.search = "?acknowledge=1" + (token ? "&token=" + encodeURIComponent(token) : "");
  socket = isReplay ? new Player() : solver ? new WorkerSocket(solver) : new WebSocket(address);
  socket.binaryType = "arraybuffer";
  socket.onopen = () => {
    attempts = arrived = waiting = 0;
    tell("connection", { isOpen: true, attempts });
  };
  socket.onmessage = ({ data }: { data: string | ArrayBuffer }) =>
    typeof data === "string" ? readText(JSON.parse(data) as Text) : readMessage(data);
  socket.onclose = () => {
    attempts += 1;
    for (const { fail } of questions.values()) fail(new Error("The connection was lost."));
    questions.clear();
    tell("connection", { isOpen: false, attempts });
    clearTimeout(timer);
    timer = window.setTimeout(connect, Math.min(3000, 250 * attempts));
  };
}

/** Answers go to who asked. A server that shows something else is shown by another page. */
function readText(message: Text) {
  const id = message.type === "done" || message.type === "error" ? (message.id ?? 0) : 0;
  const question = questions.get(id);
  questions.delete(id);
  const isOther = message.type === "hello" && page.hello && `${page.hello.scalars}` !== `${message.scalars}`;
  if (isOther) location.reload();
  else if (message.type === "state" && !page.hello)
    return; // for the pages before this one
  else if (!question) tell(message.type, message as never);
  else if (message.type === "error") question.fail(new Error(message.message));
  else question.done();
}

function readMessage(data: ArrayBuffer) {
  const message = decode(data);
  if (message.file) tell("file", message.file);
  else if (message.past) tell("past", message.past);
  else if (message.grid) tell("scene", message);
  else if (message.scalars) {
    arrived += 1;
    waiting += 1;
    if (page.hello) tell("frame", message as Frame);
  }
}
