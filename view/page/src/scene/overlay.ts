import { get } from "../dom";
import type { Pose } from "../protocol";
import type { Camera } from "./camera";

const captionRoom = 44; // pixels, where the caption is as wide as the stage
const margin = 8; // pixels between a panel and what is fitted

/** The pixels at the edges of the stage that panels cover: at its sides if there is room, else at its top. */
export function coveredByPanels(): Camera["covered"] {
  const layers = get<HTMLDetailsElement>("layers");
  const box = get("stage").getBoundingClientRect();
  const figures = get("readout").getBoundingClientRect();
  const right = figures.width ? box.right - figures.left + margin : 0;
  const panel = layers.getBoundingClientRect();
  const left = layers.open ? panel.right - box.left + margin : 0;
  const top =
    Math.max(figures.width ? figures.bottom : box.top, layers.open ? 0 : panel.bottom) - box.top + margin;
  if (box.width - left - right > 0.5 * box.width && box.width > box.height)
    return { left, right, top: left ? 0 : panel.bottom - box.top + margin, bottom: 0 };
  const aside = left < 0.5 * box.width ? left : 0;
  return { left: aside, right: 0, top: Math.min(top, 0.4 * box.height), bottom: captionRoom };
}

/** Puts a label behind its car, so that it does not hide the plan; `further` lengths of the label away. */
export function place(label: HTMLElement, at: Pose | undefined, camera: Camera, further = 0) {
  label.hidden = !at;
  if (!at) return;
  const [x, y] = camera.toScreen(at.x, at.y);
  const ahead = at.yaw + camera.turn;
  const h = Math.cos(ahead);
  const v = -Math.sin(ahead);
  const width = label.offsetWidth;
  const height = label.offsetHeight;
  const away = 0.36 * camera.zoom + 8 + (0.5 + further) * (Math.abs(h) * width + Math.abs(v) * (height + 4));
  const inside = (at: number, size: number, from: number, room: number) =>
    Math.round(from + Math.max(margin, Math.min(room - size - margin, at - from)));
  const left = inside(x - h * away - width / 2, width, camera.left, camera.width);
  let top = inside(y - v * away - height / 2, height, camera.top, camera.height);
  // Below its car where the edge of the view pushes it over the car.
  const half = 0.2 * camera.zoom + 4;
  const isOver = Math.abs(x - left - width / 2) < half + width / 2 && Math.abs(y - top - height / 2) < half;
  if (isOver) top = inside(y + half + further * height, height, camera.top, camera.height);
  label.style.transform = `translate(${left}px, ${top}px)`;
}

/** A round length (m) that is at least 48 pixels long. */
export const rulerMetres = (zoom: number) =>
  [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100].find((m) => m * zoom >= 48) ?? 200;

/** Shows the ruler and its length. */
export function showRuler(camera: Camera) {
  const metres = rulerMetres(camera.zoom);
  get("ruler-text").textContent = metres + " m";
  get("ruler-bar").style.width = metres * camera.zoom + "px";
}
