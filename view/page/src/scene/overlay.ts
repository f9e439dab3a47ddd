import { counted, get } from "../dom";
import { Caption } from "../modes";
import { drivenOf, methodOf, on, page, period, scalar } from "../page";
import type { Frame, Pose } from "../protocol";
import type { Camera } from "./camera";
import { visible } from "./layers";
import { camera, ghostCamera, isSideBySide } from "./stage";

// All that lies over the scene: labels, the ruler, and titles and captions of the lanes with the line between.

const inside = 8; // pixels between a label and the edge of its view
const margin = 12; // pixels beside a caption
const lanes = [
  { camera, title: get("lane-title"), line: get("modes"), caption: new Caption(get("modes")) },
  {
    camera: ghostCamera,
    title: get("ghost-lane-title"),
    line: get("ghost-modes"),
    caption: new Caption(get("ghost-modes")),
  },
];

/** Shows titles and captions. */
function showLanes(frame: Frame) {
  get("split").hidden = get("faint").hidden = !frame.ghostFrame;
  const both = isSideBySide() ? [frame, frame.ghostFrame!] : [frame, undefined];
  for (const [i, each] of both.entries()) {
    const isShown = visible.has("modes");
    lanes[i].caption.show(methodOf(each), isShown ? each : undefined, scalar("tick") * period());
    const collisions = counted(scalar("contacts", each?.scalars), "collision");
    lanes[i].title.textContent = `${methodOf(each)} · ${collisions}`;
  }
}
on("frame", showLanes);
// A frame is judged again once the drive is paused there.
on("state", ({ paused }) => paused && page.frame && showLanes(page.frame));

/** The middle of what panels leave free of a lane. */
function box({ width, covered, middleX }: Camera, stage: HTMLElement) {
  const free = Math.max(120, width - covered.left - covered.right - 2 * margin);
  return `left:${Math.min(middleX, stage.clientWidth)}px;max-width:${free}px;`;
}

/** Puts titles, captions and the line between the lanes to their places. */
function placeLanes() {
  const on = isSideBySide();
  const stage = get("stage");
  stage.classList.toggle("split", on);
  for (const { camera, title, line } of lanes) {
    const bottom = stage.clientHeight - camera.top - camera.height + margin;
    title.hidden = !on;
    title.style.cssText = `${box(camera, stage)}top:${camera.top + camera.covered.top - 32}px`;
    line.style.cssText = on ? `${box(camera, stage)}bottom:${bottom}px` : "";
  }
  const { left, top } = ghostCamera;
  const divider = get("divider");
  divider.hidden = !on;
  divider.style.cssText =
    top > 0 ? `top:${top}px;left:0;right:0;height:1px` : `left:${left}px;top:0;bottom:0;width:1px`;
}

/** Puts a label behind its body, so that it does not hide the plan; `further` lengths of the label away. */
function placeLabel(label: HTMLElement, at: Pose | undefined, further = 0) {
  label.hidden = !at;
  if (!at) return;
  const [x, y] = camera.toScreen(at.x, at.y);
  const ahead = at.yaw + camera.turn;
  const h = Math.cos(ahead);
  const v = -Math.sin(ahead);
  const width = label.offsetWidth;
  const height = label.offsetHeight;
  const size = (page.hello?.body.length ?? 0) * camera.zoom; // pixels
  const away = 0.62 * size + 8 + (0.5 + further) * (Math.abs(h) * width + Math.abs(v) * (height + 4));
  const within = (at: number, size: number, from: number, room: number) =>
    Math.round(from + Math.max(inside, Math.min(room - size - inside, at - from)));
  const left = within(x - h * away - width / 2, width, camera.left, camera.width);
  let top = within(y - v * away - height / 2, height, camera.top, camera.height);
  // Below its body where the edge of the view pushes it over the body.
  const half = 0.35 * size + 4;
  const isOver = Math.abs(x - left - width / 2) < half + width / 2 && Math.abs(y - top - height / 2) < half;
  if (isOver) top = within(y + half + further * height, height, camera.top, camera.height);
  label.style.transform = `translate(${left}px, ${top}px)`;
}

/** A round length (m) that is at least 48 pixels long. */
export const rulerMetres = (zoom: number) =>
  [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100].find((m) => m * zoom >= 48) ?? 200;

on("drawn", () => {
  placeLanes();
  const driven = drivenOf(page.frame);
  const ghost = visible.has("ghost") ? drivenOf(page.frame?.ghostFrame) : undefined;
  placeLabel(get("label"), driven);
  const isNear = driven && ghost && Math.hypot(driven.x - ghost.x, driven.y - ghost.y) < 2 * driven.length;
  placeLabel(get("ghost-label"), ghost, isNear ? 1 : 0);
  const metres = rulerMetres(camera.zoom);
  get("ruler-text").textContent = metres + " m";
  get("ruler-bar").style.width = metres * camera.zoom + "px";
});
