import { all, click, get, press } from "../dom";
import { can, isIntroduction, on, page, redraw } from "../page";
import { Camera } from "./camera";

// The stage with its cameras: one for the whole stage, or one for the car's lane and one for the ghost's.

export const camera = new Camera();
export const ghostCamera = new Camera();
/** Whether the ghost is to be shown beside the car, in a lane of its own. */
export let isSplit = false;
/** Whether it is. */
export const isSideBySide = () => isSplit && page.frame?.ghostFrame !== undefined;

const canvas = get<HTMLCanvasElement>("scene");
const captionRoom = 44; // pixels, where the caption is as wide as the stage
const margin = 8; // pixels between a panel and what is fitted
const room = { top: 40, bottom: 72 }; // pixels of a lane that its title and caption cover
/** The size of the stage, and the pixels at its edges that panels cover. */
export let size = { width: 1, height: 1, covered: camera.covered };
/** Where the stage is narrow, the panels are above and below it. */
export const narrow = matchMedia("(max-width: 899px)");

/** The pixels at the edges of the stage that panels cover: at its sides if there is room, else at its top. */
function coveredByPanels(): Camera["covered"] {
  if (narrow.matches) return { left: 0, right: 0, top: 0, bottom: 0 };
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

/** Measures the stage, and puts the cameras to their places. */
function layOut() {
  const { clientWidth: width, clientHeight: height } = get("stage");
  const covered = coveredByPanels();
  const { hidden, offsetTop, offsetHeight } = get("introduction");
  if (!hidden && !narrow.matches) covered.top = Math.max(covered.top, offsetTop + offsetHeight);
  size = { width, height, covered };
  keepFitted(placeCameras);
  redraw();
}
const resized = new ResizeObserver(layOut);
for (const id of ["stage", "layers", "readout", "introduction"]) resized.observe(get(id));

/** Whether two lanes are larger beside one another than one above the other. */
function isBeside(width: number, height: number) {
  if (camera.follow !== "free") return width >= 0.7 * height;
  const [x0, y0, x1, y1] = bounds;
  const zoom = (w: number, h: number) => Math.min(w / (x1 - x0), h / (y1 - y0));
  return zoom(width / 2, height) >= zoom(width, height / 2);
}

/** Puts the cameras to the whole stage, or beside one another, or one above the other on a high stage. */
export function placeCameras() {
  const { width, height, covered } = size;
  if (!isSideBySide()) {
    Object.assign(camera, { left: 0, top: 0, ...size });
    return;
  }
  const bottom = narrow.matches ? 0 : room.bottom;
  if (isBeside(width, height)) {
    const middle = Math.round((covered.left + width - covered.right) / 2);
    const free = { top: covered.top + room.top, bottom, left: 0, right: 0 };
    const own = { top: 0, height };
    Object.assign(camera, own, { left: 0, width: middle, covered: { ...free, left: covered.left } });
    const second = { left: middle, width: width - middle, covered: { ...free, right: covered.right } };
    Object.assign(ghostCamera, own, second);
  } else {
    const middle = Math.round((covered.top + height) / 2);
    const free = { left: covered.left, right: covered.right, top: room.top, bottom };
    const own = { left: 0, width };
    Object.assign(camera, own, { top: 0, height: middle, covered: { ...free, top: covered.top + room.top } });
    Object.assign(ghostCamera, own, { top: middle, height: height - middle, covered: free });
  }
  const { x, y, zoom, turn, follow } = camera;
  Object.assign(ghostCamera, { zoom, turn, follow }, follow === "free" ? { x, y } : {});
}

/** Shows car and ghost side by side, or in one picture. */
export function setSplit(on: boolean) {
  isSplit = on;
  press(get("split"), on);
  layOut();
}

click("split", () => page.frame?.ghostFrame && setSplit(!isSplit));

/** The place of a pointer on the stage, in the lane of the car; `isGhost`: it is in that of the ghost. */
export function placeOf(e: MouseEvent) {
  const box = canvas.getBoundingClientRect();
  const p = { x: e.clientX - box.left, y: e.clientY - box.top };
  const isGhost = isSideBySide() && p.x >= ghostCamera.left && p.y >= ghostCamera.top;
  const [x, y] = isGhost ? camera.toScreen(...ghostCamera.toMap(p.x, p.y)) : [p.x, p.y];
  return { x, y, isGhost };
}

/** A box around all that is drawn, with some room, m. */
export let bounds = [-5, -5, 5, 5];
let fitted = "";
const where = () => (camera.follow === "free" ? [camera.x, camera.y, camera.zoom].join() : "not fitted");
let isHeld = false;
/** Keeps the scene where it is while a pointer is pressed on it. */
export const hold = (on: boolean) => (isHeld = on);

/** Shows all that is drawn. */
export function fit() {
  camera.fit(bounds[0], bounds[1], bounds[2], bounds[3]);
  fitted = where();
  redraw();
}
/** Changes something after which a scene that was fitted is fitted again. */
function keepFitted(change: () => void) {
  const isFitted = fitted === where();
  change();
  if (isFitted && !isHeld) fit();
}

export function follow(what: "follow" | "heading") {
  if (fitted === where()) camera.zoom = drivingZoom();
  camera.follow = what;
  redraw();
}
/** Pixels per m with which the surroundings of the driven body are seen: about 16 of its lengths. */
function drivingZoom() {
  if (isIntroduction) return camera.room / 6.2; // m, until behind the parked car
  const length = page.hello?.body.length || (bounds[2] - bounds[0]) / 16;
  return camera.room / (15.5 * length);
}
/** Follows the body, with its heading up or not. */
export const turnFollow = () => follow(camera.follow === "follow" ? "heading" : "follow");
for (const b of all("[data-follow]"))
  b.onclick = () => (b.dataset.follow === "fit" ? fit() : follow(b.dataset.follow as "follow"));

const stride = 40; // pixels that an arrow key moves the view
export function move(x: number, y: number) {
  camera.pan(x * stride, y * stride);
  redraw();
}
export function zoom(factor: number) {
  camera.zoomAt(camera.middleX, camera.middleY, factor);
  redraw();
}

const isStill = matchMedia("(prefers-reduced-motion: reduce)");
let isBegun = false;
on("state", (state) => {
  const [x0, y0, x1, y1] = state.bounds;
  const room = 0.12 * Math.max(x1 - x0, y1 - y0, 1e-9);
  keepFitted(() => (bounds = [x0 - room, y0 - room, x1 + room, y1 + room]));
  if (isBegun) return;
  isBegun = true;
  if (state.ghost && can("live")) setSplit(true);
  fit();
  if (page.scene?.path) follow(isIntroduction && !isStill.matches ? "heading" : "follow");
});
on("drawn", () => {
  // A drag may have changed what the camera follows.
  const now = fitted === where() ? "fit" : camera.follow;
  for (const b of all("[data-follow]")) press(b, b.dataset.follow === now);
});
