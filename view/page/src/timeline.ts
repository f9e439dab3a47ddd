import { get } from "./dom";
import { isReplay, page, scalar } from "./page";

const thumb = 16; // px, width of the slider's thumb

/** The slider over the stored steps, with a mark at the time under the pointer. */
export class Timeline {
  private scrubbing = false;
  private readonly slider = get<HTMLInputElement>("timeline");
  private readonly mark = get("timeline-mark");
  private readonly text = get("time");

  constructor(seek: (position: number) => void, hovered: (position: number | undefined) => void) {
    this.slider.oninput = () => {
      this.scrubbing = true;
      seek(Number(this.slider.value));
    };
    this.slider.onchange = () => (this.scrubbing = false);
    this.slider.addEventListener("pointermove", (e) => hovered(this.under(e)));
    this.slider.addEventListener("pointerleave", () => hovered(undefined));
    if (isReplay) this.slider.setAttribute("aria-label", "Time in the recording");
  }

  /** `newest`: position of the newest frame. */
  show(newest: number) {
    const { slider } = this;
    const state = page.state!;
    const shown = state.paused || isReplay ? state.tick : newest;
    slider.min = String(Math.max(0, state.oldest));
    slider.max = String(Math.max(1, newest));
    if (!this.scrubbing) slider.value = String(shown);
    const seconds = (steps: number) => (steps * state.control_period).toFixed(1);
    const back = (newest - Number(slider.value)) * state.control_period;
    if (isReplay) this.text.textContent = `${seconds(state.tick)} of ${seconds(newest)} s`;
    else
      this.text.textContent = back > 1e-6 ? `−${back.toFixed(2)} s` : `${(scalar("time") || 0).toFixed(2)} s`;
    slider.setAttribute("aria-valuetext", this.text.textContent);
  }

  private get range() {
    return [Number(this.slider.min), Number(this.slider.max)];
  }

  showCursor(position: number | undefined) {
    const [from, to] = this.range;
    this.mark.hidden = position === undefined || position < from || position > to;
    const share = ((position ?? from) - from) / (to - from);
    this.mark.style.left = `calc(${thumb / 2}px + ${share} * (100% - ${thumb}px))`;
  }

  private under(e: PointerEvent): number {
    const box = this.slider.getBoundingClientRect();
    const share = (e.clientX - box.left - thumb / 2) / (box.width - thumb);
    const [from, to] = this.range;
    return Math.round(from + Math.min(1, Math.max(0, share)) * (to - from));
  }
}
