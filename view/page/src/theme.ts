import { get } from "./dom";
import { layers } from "./scene/layers";
import { css, rampCss, themes, type Theme } from "./scene/palette";

type Name = "dark" | "light";
const key = "slalom-theme";

/** The theme chosen before. A page opened from disk may not be allowed to store it. */
function stored(): Name | null {
  try {
    return localStorage.getItem(key) as Name | null;
  } catch {
    return null;
  }
}

/** The dark or the light theme: the one chosen before, else the one that the system prefers. */
export class Themes {
  private name: Name = stored() ?? (matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark");

  get now(): Theme {
    return themes[this.name];
  }

  toggle() {
    this.name = this.name === "dark" ? "light" : "dark";
    try {
      localStorage.setItem(key, this.name);
    } catch {
      // The choice is forgotten.
    }
    this.apply();
  }

  /** Colours the page and the swatches of the layers. */
  apply() {
    const t = this.now;
    document.documentElement.dataset.theme = this.name;
    get("ramp").style.background = rampCss(t);
    for (const [name, , , colour] of layers) {
      const c = colour && t[colour];
      const swatch = document.querySelector<HTMLElement>(`[data-swatch=${name}]`)!;
      swatch.style.background = c ? css([c[0], c[1], c[2], Math.max(0.45, c[3])]) : rampCss(t);
    }
  }
}
