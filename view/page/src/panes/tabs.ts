import { get } from "../dom";
import { tell } from "../page";

export type Pane = "charts" | "options" | "laps";

const list = get("tabs");
const tabs = [...list.querySelectorAll<HTMLElement>('[role="tab"]')];

/** Shows a pane, whose tab is chosen by pointer or keys. */
export function showPane(name: Pane) {
  for (const tab of tabs) {
    const isShown = tab.dataset.pane === name;
    tab.classList.toggle("on", isShown);
    tab.setAttribute("aria-selected", String(isShown));
    tab.tabIndex = isShown ? 0 : -1;
    get("pane-" + tab.dataset.pane).hidden = !isShown;
  }
  tell("shown", name);
}

for (const tab of tabs) tab.onclick = () => showPane(tab.dataset.pane as Pane);
list.onkeydown = (event) => {
  const all = tabs.filter((tab) => !tab.hidden);
  const at = all.indexOf(document.activeElement as HTMLElement);
  const to = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: all.length - 1 }[event.key];
  if (to === undefined) return;
  const tab = all[(to + all.length) % all.length];
  showPane(tab.dataset.pane as Pane);
  tab.focus();
  event.preventDefault();
};
