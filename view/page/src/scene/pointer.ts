import { isReplay, page, redraw, send } from "../page";
import type { Body } from "../protocol";
import type { SceneView } from "./scene";

export type Tool = "disc" | "box" | "car" | "pan";

const slack = 5; // pixels that a click may move
const gap = 40; // ms between two messages of a drag
const longPress = 600; // ms that a finger rests on an obstacle to delete it

/** Whether a body can be dragged. Opponents and movers go by themselves; a problem says what can be moved. */
function isMovable({ kind }: Body) {
  const { can_place, can_move } = page.hello?.problem ?? { can_place: true, can_move: true };
  return !isReplay && kind !== 4 && kind !== 5 && (kind === 0 ? can_place : can_move);
}

/**
 * Mouse, pen and fingers on the scene: pan, zoom, pinch, place, drag, delete. `clicked`: whether a click at a
 * place of the map frame (m) meant something else.
 */
export function attachPointer(
  canvas: HTMLCanvasElement,
  scene: SceneView,
  tool: () => Tool,
  clicked: (x: number, y: number) => boolean,
) {
  const pointers = new Map<number, { x: number; y: number }>();
  let start: { x: number; y: number } | undefined;
  let moved = false;
  let dragged: Body | undefined;
  let grip = { x: 0, y: 0 };
  let sent = 0;
  let drag = 0; // number of the drag, whose steps are undone together
  let pressed = 0; // timer of a long press

  let inGhostLane = false; // where the first pointer went down
  /** Where the pointer is, in the lane of the car. */
  const place = (e: PointerEvent | MouseEvent) => {
    const box = canvas.getBoundingClientRect();
    const p = { x: e.clientX - box.left, y: e.clientY - box.top };
    if (!pointers.size) inGhostLane = scene.isSideBySide && scene.stage.isInGhostLane(p);
    return inGhostLane ? scene.stage.fromGhostLane(p) : p;
  };
  /** Finds the thing to grasp at a point of the map frame. The driven car is not in the ghost's lane. */
  const bodyAt = (x: number, y: number) => {
    const body = scene.bodyAt(x, y);
    return body && isMovable(body) && !(inGhostLane && body.kind === 0) ? body : undefined;
  };
  const remove = (body: Body | undefined) => {
    if (!body || body.kind === 0 || page.hello?.problem) return false;
    send({ do: "remove", body: body.id });
    return true;
  };
  const move = (body: Body, x: number, y: number) => {
    if (body.kind === 0) send({ do: "place_car", x, y, yaw: body.yaw });
    else send({ do: "move", body: body.id, x, y, yaw: body.yaw, drag });
  };

  canvas.addEventListener("pointerdown", (e) => {
    canvas.focus({ preventScroll: true });
    canvas.setPointerCapture(e.pointerId);
    const p = place(e);
    pointers.set(e.pointerId, p);
    scene.isHeld = true;
    clearTimeout(pressed);
    if (pointers.size > 1) {
      dragged = undefined;
      moved = true;
      return;
    }
    if (e.button !== 0) return;
    start = p;
    moved = false;
    const [x, y] = scene.camera.toMap(p.x, p.y);
    dragged = bodyAt(x, y);
    scene.selected = dragged && dragged.kind !== 0 ? dragged.id : -1;
    drag = 1 + Math.floor(1e9 * Math.random()); // other pages drag too
    if (dragged) grip = { x: dragged.x - x, y: dragged.y - y };
    if (e.pointerType === "touch")
      pressed = window.setTimeout(() => {
        if (start && !moved && remove(dragged)) start = dragged = undefined;
      }, longPress);
    redraw();
  });

  canvas.addEventListener("pointermove", (e) => {
    const p = place(e);
    const before = pointers.get(e.pointerId);
    if (!before) {
      const [x, y] = scene.camera.toMap(p.x, p.y);
      const over = bodyAt(x, y);
      const kind = { disc: 3, box: 2, car: 1, pan: 0 }[tool()];
      canvas.style.cursor = over ? "grab" : tool() === "pan" ? "default" : "crosshair";
      scene.preview = over || !kind || e.pointerType === "touch" ? undefined : { x, y, kind };
      redraw();
      return;
    }
    if (pointers.size === 2) {
      const other = [...pointers].find(([id]) => id !== e.pointerId)![1];
      const was = Math.hypot(before.x - other.x, before.y - other.y);
      const is = Math.hypot(p.x - other.x, p.y - other.y);
      if (was > 1) scene.camera.zoomAt((p.x + other.x) / 2, (p.y + other.y) / 2, is / was);
      scene.camera.pan((p.x - before.x) / 2, (p.y - before.y) / 2);
    } else if (start) {
      if (Math.hypot(p.x - start.x, p.y - start.y) > slack) {
        moved = true;
        clearTimeout(pressed);
      }
      if (moved && dragged) {
        const [x, y] = scene.camera.toMap(p.x, p.y);
        if (performance.now() - sent > gap) {
          sent = performance.now();
          move(dragged, x + grip.x, y + grip.y);
        }
      } else if (moved) {
        canvas.classList.add("panning");
        scene.camera.pan(p.x - before.x, p.y - before.y);
      }
    }
    scene.preview = undefined;
    pointers.set(e.pointerId, p);
    redraw();
  });

  const up = (e: PointerEvent) => {
    const p = place(e);
    pointers.delete(e.pointerId);
    scene.isHeld = pointers.size > 0;
    clearTimeout(pressed);
    canvas.classList.remove("panning");
    if (!start || pointers.size) return;
    const [x, y] = scene.camera.toMap(p.x, p.y);
    if (dragged && moved) move(dragged, x + grip.x, y + grip.y);
    else if (!moved && e.type === "pointerup" && !clicked(x, y) && !dragged && tool() !== "pan") drop(x, y);
    start = dragged = undefined;
    redraw();
  };
  const drop = (x: number, y: number) => {
    const kind = tool();
    const car = page.frame?.bodies[0];
    const yaw = kind === "car" && car ? car.yaw : 0;
    send({ do: "add", kind, x, y, yaw, length: kind === "disc" ? 0.3 : 0.4, width: 0.4 });
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("pointerleave", () => {
    scene.preview = undefined;
    redraw();
  });
  canvas.addEventListener("contextmenu", (e) => {
    e.preventDefault();
    const p = place(e);
    remove(bodyAt(...scene.camera.toMap(p.x, p.y)));
  });
  canvas.addEventListener(
    "wheel",
    (e) => {
      e.preventDefault();
      const p = place(e);
      scene.camera.zoomAt(p.x, p.y, Math.exp(-e.deltaY * (e.deltaMode === 1 ? 0.05 : 0.0015)));
      redraw();
    },
    { passive: false },
  );
}
