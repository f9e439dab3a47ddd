import type { State } from "./protocol";

/** The slider over the stored steps, with a mark at the time under the pointer. */
export class Timeline {
  private scrubbing = false;
  private readonly slider = document.getElementById("timeline") as HTMLInputElement;
  private readonly mark = document.getElementById("timeline-mark")!;
  private readonly text = document.getElementById("time")!;

  constructor(private readonly isReplay: boolean, seek: (position: number) => void, hovered: (position: number | undefined) => void) {
    this.slider.oninput = () => { this.scrubbing = true; seek(Number(this.slider.value)); };
    this.slider.onchange = () => (this.scrubbing = false);
    this.slider.addEventListener("pointermove", (e) => hovered(this.under(e)));
    this.slider.addEventListener("pointerleave", () => hovered(undefined));
    if (isReplay) this.slider.setAttribute("aria-label", "Time in the recording");
  }

  /** `newest`: position of the newest frame; `time`: s, of the frame that is shown. */
  show(state: State, newest: number, time: number) {
    const { slider } = this, shown = state.paused || this.isReplay ? state.tick : newest;
    slider.min = String(Math.max(0, state.oldest));
    slider.max = String(Math.max(1, newest));
    if (!this.scrubbing) slider.value = String(shown);
    const back = (newest - Number(slider.value)) * state.control_period;
    if (this.isReplay) this.text.textContent = `${(state.tick * state.control_period).toFixed(1)} of ${(newest * state.control_period).toFixed(1)} s`;
    else this.text.textContent = back > 1e-6 ? `−${back.toFixed(2)} s` : `${(time || 0).toFixed(2)} s`;
    slider.setAttribute("aria-valuetext", this.text.textContent);
  }

  showCursor(position: number | undefined) {
    const from = Number(this.slider.min), to = Number(this.slider.max);
    this.mark.hidden = position === undefined || position < from || position > to;
    if (position !== undefined) this.mark.style.left = `calc(${thumb / 2}px + ${(position - from) / (to - from)} * (100% - ${thumb}px))`;
  }

  private under(e: PointerEvent): number {
    const box = this.slider.getBoundingClientRect(), share = (e.clientX - box.left - thumb / 2) / (box.width - thumb);
    const from = Number(this.slider.min), to = Number(this.slider.max);
    return Math.round(from + Math.min(1, Math.max(0, share)) * (to - from));
  }
}

const thumb = 16; // px, width of the slider's thumb
