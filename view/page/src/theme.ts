import { rampCss, themes, type Theme } from "./scene/palette";
import { layers } from "./scene/layers";

type Name = "dark" | "light";
const key = "slalom-theme";

/** The theme chosen before. A page opened from disk may not be allowed to store it. */
function stored(): Name | null {
  try { return localStorage.getItem(key) as Name | null; } catch { return null; }
}

/** Dark or light: what was chosen before, else what the system prefers. */
export class Themes {
  private name: Name = stored() ?? (matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark");

  get now(): Theme { return themes[this.name]; }

  toggle() {
    this.name = this.name === "dark" ? "light" : "dark";
    try { localStorage.setItem(key, this.name); } catch { /* storage is not available */ }
    this.apply();
  }

  /** Colours the page and the swatches of the layers. */
  apply() {
    const t = this.now;
    document.documentElement.dataset.theme = this.name;
    document.getElementById("ramp")!.style.background = rampCss(t);
    const colours = { costMap: t.cost, path: t.path, scan: t.scan, candidates: undefined, guides: t.guide, nominal: t.nominal, plan: t.plan, spread: t.spread, driven: t.driven, obstacles: t.obstacle, opponents: t.opponent, modes: t.nominal, ghost: t.ghost, minimap: t.path };
    for (const [layer] of layers) {
      const swatch = document.querySelector<HTMLElement>(`[data-swatch="${layer}"]`), c = colours[layer];
      if (swatch) swatch.style.background = c ? `rgb(${c.slice(0, 3).map((v) => Math.round(255 * v)).join(" ")} / ${Math.max(0.45, c[3])})` : rampCss(t);
    }
  }
}
