import { send } from "../connection";
import { all, get, press } from "../dom";
import { can, drivenOf, isReplay, on, page, redraw } from "../page";
import type { Body } from "../protocol";
import { camera, hold, placeOf } from "./stage";

// Mouse, pen and fingers on the scene: pan, zoom, pinch, place, drag, delete.

/** The body that a click places, or none. */
export type Tool = "disc" | "box" | "car" | "pan";

const slack = 5; // pixels that a click may move
const gap = 40; // ms between two messages of a drag
const longPress = 600; // ms that a finger rests on an obstacle to delete it
const reach = 8; // pixels beside a body that still mean it

let tool: Tool = "disc";
/** The number of the body that is selected; -1 if there is none. */
export let selected = -1;
/** The place of the body that a click adds. */
export let preview: { x: number; y: number; kind: number } | undefined;

export function setTool(to: Tool) {
  if (to !== "pan" && !can("add")) return;
  tool = to;
  for (const b of all("[data-tool]")) press(b, b.dataset.tool === tool);
}
for (const b of all("[data-tool]")) b.onclick = () => setTool(b.dataset.tool as Tool);
on("hello", () => setTool(can("add") ? tool : "pan"));

export function deleteSelected() {
  if (selected > 0) send({ do: "remove", body: selected });
  selected = -1;
}

/** Whether a body can be dragged. Opponents and people go by themselves. */
const isMovable = ({ kind }: Body) =>
  !isReplay && kind !== 4 && kind !== 5 && can(kind === 0 ? "place" : "move");

/** The body to grasp at a point of the map frame. The driven one is not in the ghost's lane. */
function bodyAt(x: number, y: number, inGhostLane: boolean): Body | undefined {
  const room = reach / camera.zoom;
  const body = page.frame?.bodies.findLast((b) => {
    const [c, s, dx, dy] = [Math.cos(b.yaw), Math.sin(b.yaw), x - b.x, y - b.y];
    const isWithin = (d: number, size: number) => Math.abs(d) <= size / 2 + room;
    return isWithin(c * dx + s * dy, b.length) && isWithin(c * dy - s * dx, b.width);
  });
  return body && isMovable(body) && !(inGhostLane && body.kind === 0) ? body : undefined;
}

function remove(body: Body | undefined) {
  if (!body || body.kind === 0 || !can("add")) return false;
  send({ do: "remove", body: body.id });
  return true;
}

function drop(x: number, y: number) {
  if (tool === "pan") return;
  const yaw = tool === "car" ? (drivenOf(page.frame)?.yaw ?? 0) : 0;
  send({ do: "add", kind: tool, x, y, yaw, length: tool === "disc" ? 0.3 : 0.4, width: 0.4 });
}

interface Place {
  x: number;
  y: number;
}
const canvas = get<HTMLCanvasElement>("scene");
const pointers = new Map<number, Place>();
let start: (Place & { isGhost: boolean }) | undefined; // where the first pointer went down
let moved = false;
let dragged: Body | undefined;
let grip = { x: 0, y: 0 };
let sent = 0; // ms, when the drag was sent last
let drag = 0; // number of the drag, whose steps are undone together
let pressed = 0; // timer of a long press

/** Sends where a body is dragged to. */
function moveTo(body: Body, p: Place) {
  const [mapX, mapY] = camera.toMap(p.x, p.y);
  const [x, y] = [mapX + grip.x, mapY + grip.y];
  if (body.kind === 0) send({ do: "place_car", x, y, yaw: body.yaw });
  else send({ do: "move", body: body.id, x, y, yaw: body.yaw, drag });
}

canvas.onpointerdown = (e) => {
  canvas.focus({ preventScroll: true });
  canvas.setPointerCapture(e.pointerId);
  const p = placeOf(e);
  pointers.set(e.pointerId, p);
  hold(true);
  clearTimeout(pressed);
  if (pointers.size > 1) {
    dragged = undefined;
    moved = true;
    return;
  }
  if (e.button !== 0) return;
  start = p;
  moved = false;
  const [x, y] = camera.toMap(p.x, p.y);
  dragged = bodyAt(x, y, p.isGhost);
  selected = dragged && dragged.kind !== 0 ? dragged.id : -1;
  drag = 1 + Math.floor(1e9 * Math.random()); // other pages drag too
  if (dragged) grip = { x: dragged.x - x, y: dragged.y - y };
  if (e.pointerType === "touch")
    pressed = window.setTimeout(() => {
      if (start && !moved && remove(dragged)) start = dragged = undefined;
    }, longPress);
  redraw();
};

/** Shows what a click would do. */
function showPreview(e: PointerEvent, p: ReturnType<typeof placeOf>) {
  const [x, y] = camera.toMap(p.x, p.y);
  const over = bodyAt(x, y, p.isGhost);
  const kind = { disc: 3, box: 2, car: 1, pan: 0 }[tool];
  canvas.style.cursor = over ? "grab" : tool === "pan" ? "default" : "crosshair";
  preview = over || !kind || e.pointerType === "touch" ? undefined : { x, y, kind };
}

canvas.onpointermove = (e) => {
  const p = placeOf(e);
  const before = pointers.get(e.pointerId);
  redraw();
  if (!before) return showPreview(e, p);
  preview = undefined;
  pointers.set(e.pointerId, p);
  if (pointers.size === 2) {
    const other = [...pointers].find(([id]) => id !== e.pointerId)![1];
    const was = Math.hypot(before.x - other.x, before.y - other.y);
    const is = Math.hypot(p.x - other.x, p.y - other.y);
    if (was > 1) camera.zoomAt((p.x + other.x) / 2, (p.y + other.y) / 2, is / was);
    camera.pan((p.x - before.x) / 2, (p.y - before.y) / 2);
    return;
  }
  if (!start) return;
  if (Math.hypot(p.x - start.x, p.y - start.y) > slack) {
    moved = true;
    clearTimeout(pressed);
  }
  if (!moved) return;
  if (!dragged) {
    canvas.classList.add("panning");
    camera.pan(p.x - before.x, p.y - before.y);
  } else if (performance.now() - sent > gap) {
    sent = performance.now();
    moveTo(dragged, p);
  }
};

canvas.onpointerup = canvas.onpointercancel = (e) => {
  const p = placeOf(e);
  pointers.delete(e.pointerId);
  hold(pointers.size > 0);
  clearTimeout(pressed);
  canvas.classList.remove("panning");
  if (!start || pointers.size) return;
  const [x, y] = camera.toMap(p.x, p.y);
  if (dragged && moved) moveTo(dragged, p);
  else if (!moved && e.type === "pointerup" && !dragged) drop(x, y);
  start = dragged = undefined;
  redraw();
};
canvas.onpointerleave = () => {
  preview = undefined;
  redraw();
};
canvas.oncontextmenu = (e) => {
  e.preventDefault();
  const p = placeOf(e);
  remove(bodyAt(...camera.toMap(p.x, p.y), p.isGhost));
};
const wheel = (e: WheelEvent) => {
  e.preventDefault();
  const p = placeOf(e);
  camera.zoomAt(p.x, p.y, Math.exp(-e.deltaY * (e.deltaMode === 1 ? 0.05 : 0.0015)));
  redraw();
};
canvas.addEventListener("wheel", wheel, { passive: false });
