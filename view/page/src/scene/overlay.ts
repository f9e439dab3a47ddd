import type { Camera } from "./camera";

/** What lies over the scene: panels, labels, ruler. */

const captionRoom = 44; // pixels, where the caption is as wide as the stage
const margin = 8; // pixels between a panel and what is fitted

/** The pixels at the edges of the stage that panels cover: at its sides where there is room, else the readout at its top. */
export function coveredBy(stage: HTMLElement, layers: HTMLDetailsElement, readout: HTMLElement): Camera["covered"] {
  const box = stage.getBoundingClientRect(), figures = readout.getBoundingClientRect(), right = figures.width ? box.right - figures.left + margin : 0;
  const panel = layers.getBoundingClientRect(), left = layers.open ? panel.right - box.left + margin : 0;
  const top = Math.max(figures.width ? figures.bottom : box.top, layers.open ? 0 : panel.bottom) - box.top + margin;
  if (box.width - left - right > 0.5 * box.width && box.width > box.height) return { left, right, top: left ? 0 : panel.bottom - box.top + margin, bottom: 0 };
  return { left: left < 0.5 * box.width ? left : 0, right: 0, top: Math.min(top, 0.4 * box.height), bottom: captionRoom };
}

interface Pose { x: number; y: number; yaw: number }

/** Puts a label behind what it names, so that it does not hide the plan; `further` lengths of the label away. */
export function place(label: HTMLElement, at: Pose | undefined, camera: Camera, further = 0) {
  label.hidden = !at;
  if (!at) return;
  const [x, y] = camera.toScreen(at.x, at.y), ahead = at.yaw + camera.turn;
  const h = Math.cos(ahead), v = -Math.sin(ahead), width = label.offsetWidth, height = label.offsetHeight;
  const away = 0.36 * camera.zoom + 8 + (0.5 + further) * (Math.abs(h) * width + Math.abs(v) * (height + 4));
  const inside = (at: number, size: number, from: number, room: number) => Math.round(from + Math.max(margin, Math.min(room - size - margin, at - from)));
  label.style.transform = `translate(${inside(x - h * away - width / 2, width, camera.left, camera.width)}px, ${inside(y - v * away - height / 2, height, camera.top, camera.height)}px)`;
}

/** The length of the ruler, m, and its text. */
export function showRuler(camera: Camera, text: HTMLElement, bar: HTMLElement) {
  const metres = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20].find((m) => m * camera.zoom >= 48) ?? 20;
  text.textContent = metres + " m";
  bar.style.width = metres * camera.zoom + "px";
}
