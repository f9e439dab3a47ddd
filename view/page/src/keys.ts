import { get, make } from "./dom";

/** Controls that use all keys themselves, and those that use only the keys with which they are pressed. */
const typed = "select, textarea, input:not([type=checkbox])";
const pressed = "button, summary, a[href], [type=checkbox], [role=tab], [role=tabpanel]";
const pressing = /^( |Enter|Home|End|Arrow.*)$/;

/**
 * Keys as the help shows them, their meaning, and what each does. Names of keys with Ctrl begin with it.
 * `ofCar`: for a car on a course alone.
 */
export type Shortcut = [shown: string, meaning: string, acts: Record<string, () => void>, ofCar?: true];

/** Lists the keys in the help. Calls the function of a key unless a dialog is open or a control uses it. */
export function attachKeys(shortcuts: Shortcut[]) {
  const rows = shortcuts.flatMap(([shown, meaning, , ofCar]) => {
    const names = shown.split(" ").flatMap((key) => [make("kbd", {}, key), " "]);
    const className = ofCar ? "of-car" : "";
    return [make("dt", { className }, ...names), make("dd", { className }, meaning)];
  });
  get("keys").prepend(...rows);
  addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    if (document.querySelector("dialog[open]")) return;
    if (event.key === "Escape" && target.closest(typed)) return target.blur();
    if (target.closest(typed) || (target.closest(pressed) && pressing.test(event.key))) return;
    const key = event.ctrlKey || event.metaKey ? "Ctrl " + event.key.toLowerCase() : event.key;
    const [, , acts, ofCar] = shortcuts.find(([, , each]) => key in each) ?? [];
    const act = ofCar && document.body.matches(".own") ? undefined : acts?.[key];
    if (!act || event.altKey) return;
    act();
    event.preventDefault();
  });
}

/** Gives the focus to the scene after a control was used by pointer, so that the keys work at once. */
export function returnFocus(scene: HTMLElement) {
  let byPointer = false;
  addEventListener("pointerdown", () => (byPointer = true), true);
  addEventListener("keydown", () => (byPointer = false), true);
  const used = (event: Event) => {
    const target = event.target as HTMLElement;
    const keeps = target.closest("dialog, .menu > div, [aria-expanded], [type=text], [type=number]");
    const focused = document.activeElement;
    const isOwn = target.closest("button, summary, label, select, input")?.contains(focused);
    const isFree = focused === document.body || isOwn;
    if (byPointer && !keeps && isFree && !document.querySelector("dialog[open]"))
      scene.focus({ preventScroll: true });
  };
  document.addEventListener("change", used);
  document.addEventListener("click", (event) => {
    if ((event.target as HTMLElement).closest("button, summary, label")) used(event);
  });
}

/** Shows the pane of the tab that is chosen by pointer or keys. Returns a function that shows a pane. */
export function attachPanes(list: HTMLElement, changed: (pane: string) => void) {
  const show = (name: string) => {
    for (const tab of list.querySelectorAll<HTMLElement>('[role="tab"]')) {
      const isShown = tab.dataset.pane === name;
      tab.classList.toggle("on", isShown);
      tab.setAttribute("aria-selected", String(isShown));
      tab.tabIndex = isShown ? 0 : -1;
      get("pane-" + tab.dataset.pane).hidden = !isShown;
    }
    changed(name);
  };
  list.addEventListener("click", (event) => {
    const tab = (event.target as HTMLElement).closest<HTMLElement>('[role="tab"]');
    if (tab) show(tab.dataset.pane!);
  });
  list.addEventListener("keydown", (event) => {
    const all = [...list.querySelectorAll<HTMLElement>('[role="tab"]:not([hidden])')];
    const at = all.indexOf(document.activeElement as HTMLElement);
    const to = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: all.length - 1 }[event.key];
    if (to === undefined) return;
    const tab = all[(to + all.length) % all.length];
    show(tab.dataset.pane!);
    tab.focus();
    event.preventDefault();
  });
  return show;
}
