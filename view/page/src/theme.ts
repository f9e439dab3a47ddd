import { click } from "./dom";
import { tell } from "./page";
import { css, rampColour, themes, type Rgba, type Theme } from "./scene/palette";

// The dark or the light theme: the one chosen before, else the one that the system prefers.

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

const opaque = ([r, g, b]: Rgba): Rgba => [r, g, b, 1];

let name: Name = stored() ?? (matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark");
/** The colours of the scene. */
export let theme: Theme = themes[name];

/** Colours the page. */
export function showTheme() {
  theme = themes[name];
  const { dataset, style } = document.documentElement;
  dataset.theme = name;
  // Texts have the colours of the scene, too.
  const colours = Object.entries({ ...theme, candidates: rampColour(theme, 0, 1) });
  for (const [of, colour] of colours)
    if (Array.isArray(colour)) style.setProperty(`--scene-${of}`, css(opaque(colour as Rgba)));
  tell("theme", theme);
}

click("theme", () => {
  name = name === "dark" ? "light" : "dark";
  try {
    localStorage.setItem(key, name);
  } catch {
    // The choice is forgotten.
  }
  showTheme();
});
