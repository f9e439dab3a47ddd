import { counted, get, say } from "../dom";
import { showWays } from "../modes";
import { drivenOf, methodOf, on, page, redraw, scalar } from "../page";
import type { Pose } from "../protocol";
import type { Camera } from "./camera";
import { visible } from "./layers";
import { camera, ghostCamera, isSideBySide, narrow, size } from "./stage";

// All that lies over the scene: labels, the ruler, and titles and captions of the lanes with the line between. It is
// measured by observers only, so that drawing needs no layout of its own.

const inside = 8; // pixels between a label and the edge of its view
const margin = 12; // pixels beside a caption
const lanes = [
  { camera, title: get("lane-title"), line: get("modes") },
  { camera: ghostCamera, title: get("ghost-lane-title"), line: get("ghost-modes") },
];
const labels = [get("label"), get("ghost-label")];
const sizes = new Map<Element, { width: number; height: number }>();
const measured = new ResizeObserver((entries) => {
  for (const { target, borderBoxSize } of entries)
    sizes.set(target, { width: borderBoxSize[0].inlineSize, height: borderBoxSize[0].blockSize });
  redraw();
});
for (const label of labels) measured.observe(label);

/** Shows titles and captions. */
function showLanes() {
  const { frame } = page;
  if (!frame) return;
  get("split").hidden = get("faint").hidden = !frame.ghostFrame;
  const both = isSideBySide() ? [frame, frame.ghostFrame!] : [frame, undefined];
  for (const [i, each] of both.entries()) {
    showWays(lanes[i].line, visible.has("modes") ? each : undefined);
    const contacts = scalar("contacts", each?.scalars);
    const collisions = Number.isFinite(contacts) ? ` · ${counted(contacts, "collision")}` : "";
    say(lanes[i].title, methodOf(each) + collisions);
  }
}
/** Changes a style where it differs. */
function put(element: HTMLElement, style: string) {
  if (element.getAttribute("style") !== style) element.setAttribute("style", style);
}

/** The middle of what panels leave free of a lane. */
function box({ width, covered, middleX }: Camera) {
  const free = Math.max(120, width - covered.left - covered.right - 2 * margin);
  return `left:${Math.min(middleX, size.width)}px;max-width:${free}px;`;
}

/** Puts titles, captions and the line between the lanes to their places. */
function placeLanes() {
  const on = isSideBySide();
  get("stage").classList.toggle("split", on);
  for (const { camera, title, line } of lanes) {
    const bottom = size.height - camera.top - camera.height + margin;
    title.hidden = !on;
    put(title, `${box(camera)}top:${camera.top + camera.covered.top - 32}px`);
    put(line, on && !narrow.matches ? `${box(camera)}bottom:${bottom}px` : "");
  }
  const { left, top } = ghostCamera;
  const divider = get("divider");
  divider.hidden = !on;
  put(
    divider,
    top > 0 ? `top:${top}px;left:0;right:0;height:1px` : `left:${left}px;top:0;bottom:0;width:1px`,
  );
}

/** Puts a label behind its body, so that it does not hide the plan; `further` lengths of the label away. */
function placeLabel(label: HTMLElement, at: Pose | undefined, further = 0) {
  label.hidden = !at;
  const { width, height } = sizes.get(label) ?? {};
  if (!at || !width || !height) return;
  const [x, y] = camera.toScreen(at.x, at.y);
  const ahead = at.yaw + camera.turn;
  const h = Math.cos(ahead);
  const v = -Math.sin(ahead);
  const long = (page.hello?.body.length ?? 0) * camera.zoom; // pixels
  const away = 0.62 * long + 8 + (0.5 + further) * (Math.abs(h) * width + Math.abs(v) * (height + 4));
  const within = (at: number, size: number, from: number, room: number) =>
    Math.round(from + Math.max(inside, Math.min(room - size - inside, at - from)));
  const left = within(x - h * away - width / 2, width, camera.left, camera.width);
  let top = within(y - v * away - height / 2, height, camera.top, camera.height);
  // Below its body where the edge of the view pushes it over the body.
  const half = 0.35 * long + 4;
  const isOver = Math.abs(x - left - width / 2) < half + width / 2 && Math.abs(y - top - height / 2) < half;
  if (isOver) top = within(y + half + further * height, height, camera.top, camera.height);
  put(label, `transform: translate(${left}px, ${top}px)`);
}

/** A round length (m) that is at least 48 pixels long, and its text. */
export function ruler(zoom: number): [metres: number, text: string] {
  const least = 48 / zoom;
  const decade = 10 ** Math.floor(Math.log10(least));
  const metres = decade * (least <= 2 * decade ? 2 : least <= 5 * decade ? 5 : 10);
  const [unit, name] =
    metres >= 1000 ? [1000, "km"] : metres >= 0.5 ? [1, "m"] : metres >= 0.01 ? [0.01, "cm"] : [0.001, "mm"];
  return [metres, `${+(metres / unit).toPrecision(2)} ${name}`];
}

on("drawn", () => {
  showLanes();
  placeLanes();
  const driven = drivenOf(page.frame);
  const ghost = visible.has("ghost") ? drivenOf(page.frame?.ghostFrame) : undefined;
  placeLabel(labels[0], driven);
  const isNear = driven && ghost && Math.hypot(driven.x - ghost.x, driven.y - ghost.y) < 2 * driven.length;
  placeLabel(labels[1], ghost, isNear ? 1 : 0);
  const [metres, text] = ruler(camera.zoom);
  say(get("ruler-text"), text);
  put(get("ruler-bar"), `width: ${Math.round(metres * camera.zoom)}px`);
});
