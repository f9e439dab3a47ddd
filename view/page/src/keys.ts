/** Controls that use keys themselves. */
const controls = "button, input, select, textarea, summary, a[href], [role=tab], [role=tabpanel]";

/**
 * Calls the function of a key while neither a control nor a dialog has the focus. Ctrl Z and Ctrl Y call `undo` and
 * `redo`.
 */
export function attachKeys(keys: Record<string, () => void>, undo: () => void, redo: () => void) {
  addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    if (document.querySelector("dialog[open]") || target.closest(controls)) return;
    let act = keys[event.key];
    if (event.ctrlKey || event.metaKey) act = { z: undo, y: redo }[event.key.toLowerCase()]!;
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
    const focused = document.activeElement, isFree = focused === document.body || target.closest("button, summary, label, select, input")?.contains(focused);
    if (byPointer && !keeps && isFree && !document.querySelector("dialog[open]")) scene.focus({ preventScroll: true });
  };
  document.addEventListener("change", used);
  document.addEventListener("click", (event) => { if ((event.target as HTMLElement).closest("button, summary, label")) used(event); });
}

/** Arrow keys, Home and End move between the tabs of a list. */
export function attachTabs(list: HTMLElement, show: (pane: string) => void) {
  const tabs = () => [...list.querySelectorAll<HTMLElement>('[role="tab"]:not([hidden])')];
  list.addEventListener("click", (event) => { const tab = (event.target as HTMLElement).closest<HTMLElement>('[role="tab"]'); if (tab) show(tab.dataset.pane!); });
  list.addEventListener("keydown", (event) => {
    const all = tabs(), at = all.indexOf(document.activeElement as HTMLElement);
    const to = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: all.length - 1 }[event.key];
    if (to === undefined) return;
    const tab = all[(to + all.length) % all.length];
    show(tab.dataset.pane!);
    tab.focus();
    event.preventDefault();
  });
}
