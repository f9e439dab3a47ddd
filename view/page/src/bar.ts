import { ask, send } from "./connection";
import { all, click, get, say, showIcon } from "./dom";
import { isMonitor, isReplay, on, page, period, scalar, tell } from "./page";
import { past } from "./past";
import { toast } from "./toast";

// The bar of time: the buttons of the drive, its speed, and the slider over the stored steps.

let isPaused = false; // as it will be once the server has executed what was asked
let pending = 0; // questions that it has not answered
/** Whether an earlier step is shown, after which Play forgets what was driven. */
const isPast = () => !isReplay && !isMonitor() && page.state!.tick < page.state!.newest;
function showPlay() {
  showIcon(get("play"), isPaused ? "play" : "pause");
  say(get("play").lastChild!, !isPaused ? "Pause" : isPast() ? "Play from here" : "Play");
  get("play").classList.toggle("primary", isPaused);
}
export function play() {
  if (!page.state) return;
  const { tick, newest } = page.state;
  const forgets = isPaused && isPast();
  const answer = ask({ do: isPaused ? "play" : "pause" });
  const seconds = (steps: number) => `${(steps * period()).toFixed(2)} s`;
  if (forgets)
    toast(`Drives on from ${seconds(tick)}; the ${seconds(newest - tick)} after it are forgotten.`);
  isPaused = !isPaused;
  pending += 1;
  showPlay();
  const refuse = (error: Error) => {
    toast(error.message, true);
    isPaused = !isPaused;
    showPlay();
  };
  void answer.catch(refuse).finally(() => (pending -= 1));
}
export const step = () => send({ do: "step" });
export const restart = () => send({ do: "restart" });
export function back() {
  const { state } = page;
  if (state) send({ do: "seek", tick: (state.paused ? state.tick : state.newest) - 1 });
}
/** Pushes the car to its left (m). */
export const nudge = (left: number) => send({ do: "nudge", left });

const rate = get<HTMLSelectElement>("rate");
rate.onchange = () => send({ do: "rate", rate: Number(rate.value) });
click("play", play);
click("step", step);
click("restart", restart);
click("nudge-left", () => nudge(0.15));
click("nudge-right", () => nudge(-0.15));
all("[data-icon]").forEach((button) => showIcon(button));
if (isReplay) rate.querySelector('[value="0"]')?.remove();

const thumb = 16; // px, width of the slider's thumb
const slider = get<HTMLInputElement>("timeline");
let isScrubbing = false;
slider.oninput = () => {
  isScrubbing = true;
  send({ do: "seek", tick: Number(slider.value) });
};
slider.onchange = () => (isScrubbing = false);
const ends = () => [Number(slider.min), Number(slider.max)];
slider.onpointermove = (e) => {
  const box = slider.getBoundingClientRect();
  const share = (e.clientX - box.left - thumb / 2) / (box.width - thumb);
  const [from, to] = ends();
  tell("cursor", Math.round(from + Math.min(1, Math.max(0, share)) * (to - from)));
};
slider.onpointerleave = () => tell("cursor", undefined);
if (isReplay) slider.setAttribute("aria-label", "Time in the recording");

function showTime() {
  const { state } = page;
  if (!state) return;
  const newest = Math.max(state.newest, past.newest);
  slider.min = String(Math.max(0, state.oldest));
  slider.max = String(Math.max(1, newest));
  if (!isScrubbing) slider.value = String(state.paused || isReplay ? state.tick : newest);
  const seconds = (steps: number) => (steps * period()).toFixed(1);
  const behind = (newest - Number(slider.value)) * period();
  const now = behind > 1e-6 ? `−${behind.toFixed(2)} s` : `${(scalar("time") || 0).toFixed(2)} s`;
  const text = isReplay ? `${seconds(state.tick)} of ${seconds(newest)} s` : now;
  say(get("time"), text);
  slider.setAttribute("aria-valuetext", text);
}

on("state", (state) => {
  if (!pending) isPaused = state.paused;
  showPlay();
  rate.value = String(state.rate);
  showTime();
});
on("frame", () => !page.state?.paused && showTime());
on("cursor", (tick) => {
  const [from, to] = ends();
  const mark = get("timeline-mark");
  mark.hidden = tick === undefined || tick < from || tick > to;
  const share = ((tick ?? from) - from) / (to - from);
  mark.style.left = `calc(${thumb / 2}px + ${share} * (100% - ${thumb}px))`;
});
