import type { Blocks, Body, Frame, Scene, Text } from "./protocol";
import type { Theme } from "./scene/palette";

/** The recording inside this page, if there is one. */
export const recordings = document.querySelectorAll('script[type="application/x-slalom-replay"]');
export const isReplay = recordings.length > 0;
/** Whether this page is the introduction, which is a recording. */
export const isIntroduction = document.querySelector("meta[name=introduction]") !== null;

/** The program inside this page's folder that takes the place of a server, if there is one. */
export const solver = document.querySelector<HTMLMetaElement>('meta[name="solver"]')?.content;

type Texts = { [Type in Text["type"]]: Extract<Text, { type: Type }> };
/** All that a part of the page can be told. */
interface News extends Texts {
  frame: Frame;
  scene: Scene;
  past: Float64Array; // the scalars of consecutive steps
  file: Blocks["file"];
  connection: { isOpen: boolean; attempts: number };
  forgotten: true; // another drive has begun: nothing is known of its past
  cursor: number | undefined; // the tick under the pointer, over a chart or the slider
  shown: "charts" | "options" | "laps"; // pane
  theme: Theme;
  drawn: true; // draw the page now
}

const newest: { [What in keyof News]?: News[What] } = {};
const listeners = new Map<keyof News, ((news: never) => void)[]>();

/** The newest of each kind of news. */
export const page: Readonly<typeof newest> = newest;

/** Calls a function with all news of a kind, after the functions that were given before. */
export function on<What extends keyof News>(what: What, act: (news: News[What]) => void) {
  listeners.set(what, [...(listeners.get(what) ?? []), act]);
}

/** Tells all parts of the page. */
export function tell<What extends keyof News>(what: What, news: News[What]) {
  newest[what] = news;
  for (const act of listeners.get(what) ?? []) act(news as never);
}

let isStale = true;
/** Lets the page be drawn again. */
export const redraw = () => void (isStale = true);
for (const what of ["frame", "scene", "past", "state", "cursor", "theme"] as const) on(what, redraw);

/** Draws the page if something has changed. */
export function draw() {
  if (!isStale) return;
  isStale = false;
  tell("drawn", true);
}

/** A figure of a control step, by default of the frame that is shown; NaN if it is not known. */
export function scalar(name: string, scalars: Float64Array | undefined = page.frame?.scalars): number {
  return scalars?.[page.hello?.scalars.indexOf(name) ?? -1] ?? NaN;
}
/** The name of the method that drove a frame. */
export const methodOf = (frame: Frame | undefined) =>
  page.hello?.methods[scalar("method", frame?.scalars ?? none)] ?? "";
const none = new Float64Array();
/** The driven body of a frame. */
export const drivenOf = (frame: Frame | undefined): Body | undefined =>
  frame?.bodies.find((b) => b.kind === 0);

/** Whether the page only watches a controller that runs elsewhere. */
export const isMonitor = () => page.hello?.can.includes("watch") ?? false;
/**
 * Whether the page can do what not all pages can, such as to choose a scenario; "live": what only the drive of a
 * server can; "time": what also a replay can.
 */
export function can(what: string): boolean {
  if (what === "time") return !isMonitor();
  return !isReplay && (what === "live" ? !isMonitor() : (page.hello?.can.includes(what) ?? false));
}

/** The time between two control steps, s. */
export const period = () => page.state?.control_period ?? page.hello?.control_period ?? 0.025;
