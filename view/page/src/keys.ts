import * as bar from "./bar";
import { click, get, make } from "./dom";
import { next } from "./introduction";
import { can } from "./page";
import { openFork } from "./panes/fork";
import { redo, undo } from "./panes/options";
import { saveMenu } from "./save";
import { deleteSelected, setTool, type Tool } from "./scene/pointer";
import * as stage from "./scene/stage";

/** Controls that use all keys themselves, and those that use only the keys with which they are pressed. */
const typed = "select, textarea, input:not([type=checkbox])";
const pressed = "button, summary, a[href], [type=checkbox], [role=tab], [role=tabpanel]";
const pressing = /^( |Enter|Home|End|Arrow.*)$/;

/** Keys as the help shows them, their meaning, what each does, and what the drive must have for them. */
type Shortcut = [shown: string, meaning: string, acts: Record<string, () => void>, needs?: string];

const help = () => get<HTMLDialogElement>("help-box").showModal();
click("help", help);
const arrows = {
  ArrowLeft: () => stage.move(1, 0),
  ArrowRight: () => stage.move(-1, 0),
  ArrowUp: () => stage.move(0, 1),
  ArrowDown: () => stage.move(0, -1),
};
const undoing = { "Ctrl z": undo, "Ctrl y": redo };
const tools: Tool[] = ["disc", "box", "car", "pan"];
const choosing = Object.fromEntries(tools.map((tool, i) => [i + 1, () => setTool(tool)]));
const nudges = { "[": () => bar.nudge(0.15), "]": () => bar.nudge(-0.15) };
/** Names of keys with Ctrl begin with it. */
const shortcuts: Shortcut[] = [
  ["Space", "pause and continue", { " ": bar.play }],
  [".", "one control step forward", { ".": bar.step }],
  [",", "one control step back", { ",": bar.back }],
  ["R", "restart from the beginning", { r: bar.restart }, "time"],
  ["F", "follow the car, heading up or not", { f: stage.turnFollow }],
  ["A", "fit the course", { a: stage.fit }],
  ["G", "car and ghost side by side, or in one picture", { g: () => get("split").click() }],
  ["← → ↑ ↓", "move the view", arrows],
  ["+ -", "zoom", { "+": () => stage.zoom(1.2), "-": () => stage.zoom(1 / 1.2) }],
  ["1 2 3 4", "pole, box, parked car, select", choosing, "add"],
  ["[ ]", "push the car to its left or right", nudges, "add"],
  ["Delete", "delete the selected obstacle", { Delete: deleteSelected, Backspace: deleteSelected }, "add"],
  ["Ctrl Z, Ctrl Y", "undo and redo a change of options, method or obstacles", undoing, "live"],
  ["K", "fork from the control step shown", { k: openFork }, "ghost"],
  ["S", "save or share: picture, replay, recording, link", { s: () => saveMenu.toggle() }],
  ["L", "layers", { l: () => get("layers").toggleAttribute("open") }],
  ["N", "the next part of the introduction", { n: next }],
  ["T", "dark or light", { t: () => get("theme").click() }],
  ["?", "this help", { "?": help }],
];

const rows = shortcuts.flatMap(([shown, meaning, , needs]) => {
  const names = shown.split(" ").flatMap((key) => [make("kbd", {}, key), " "]);
  const both = [make("dt", {}, ...names), make("dd", {}, meaning)];
  if (needs) for (const each of both) each.dataset.can = needs;
  return both;
});
get("keys").prepend(...rows);

// Calls the function of a key unless a dialog is open or a control uses it.
addEventListener("keydown", (event) => {
  const target = event.target as HTMLElement;
  if (document.querySelector("dialog[open]")) return;
  if (event.key === "Escape" && target.closest(typed)) return target.blur();
  if (target.closest(typed) || (target.closest(pressed) && pressing.test(event.key))) return;
  const key = event.ctrlKey || event.metaKey ? "Ctrl " + event.key.toLowerCase() : event.key;
  const [, , acts, needs] = shortcuts.find(([, , each]) => key in each) ?? [];
  if (!acts || event.altKey || (needs && !can(needs))) return;
  acts[key]();
  event.preventDefault();
});

// Gives the focus to the scene after a control was used by pointer, so that the keys work at once.
let byPointer = false;
addEventListener("pointerdown", () => (byPointer = true), true);
addEventListener("keydown", () => (byPointer = false), true);
function returnFocus(event: Event) {
  const target = event.target as HTMLElement;
  const keeps = target.closest("dialog, .menu > div, [aria-expanded], [type=text], [type=number]");
  const focused = document.activeElement;
  const isOwn = target.closest("button, summary, label, select, input")?.contains(focused);
  const isFree = focused === document.body || isOwn;
  if (byPointer && !keeps && isFree && !document.querySelector("dialog[open]"))
    get("scene").focus({ preventScroll: true });
}
document.addEventListener("change", returnFocus);
document.addEventListener("click", (event) => {
  if ((event.target as HTMLElement).closest("button, summary, label")) returnFocus(event);
});
