import "./style.css";
import { addressOf, applyAddress } from "./address";
import { BestLap } from "./best_lap";
import { Connection } from "./connection";
import { Controls } from "./controls";
import { get, press } from "./dom";
import { attachDrive } from "./drive";
import { ScenarioFields } from "./fields";
import { Introduction } from "./introduction";
import { attachKeys, attachPanes, returnFocus, type Shortcut } from "./keys";
import { fillLists, fillTerms, foldHeader, nameProblem } from "./layout";
import type { Handlers } from "./link";
import { Charts } from "./panes/charts";
import { EvaluationPane } from "./panes/evaluation";
import { InspectPane } from "./panes/inspect";
import { ForkBox } from "./panes/fork";
import { OptionsPane } from "./panes/options";
import { ask, isReplay, page, period, redraw, scalar, send } from "./page";
import { Gaps, Past } from "./past";
import { Player } from "./player";
import { Popover } from "./popover";
import type { Hello, State, Text } from "./protocol";
import { Readout } from "./readout";
import { attachSaveMenu, saveFile } from "./save";
import { Lanes } from "./scene/lanes";
import { coveredByPanels, place, showRuler } from "./scene/overlay";
import { attachPointer } from "./scene/pointer";
import { SceneView } from "./scene/scene";
import { showConnection, showRole, showStatus } from "./status";
import { Themes } from "./theme";
import { Timeline } from "./timeline";
import { download, toast } from "./toast";

fillLists();
foldHeader();

const wanted = new URLSearchParams(location.hash.slice(1)); // scenario in the address, still to be set
let isNew = wanted.size === 0; // whether nobody has told this page what to show
const theme = new Themes();
const scene = new SceneView(get<HTMLCanvasElement>("scene"), theme.now);
const past = new Past(Infinity);
const ghostPast = new Past(Infinity);
const best = new BestLap();
const tickOf = (time: number) => Math.round(time / period());

function forgetPast() {
  past.clear();
  ghostPast.clear();
  best.forget();
  charts.zoom();
}

const handlers: Handlers = {
  frame(next, at) {
    page.frame = next;
    showFrame(at);
  },
  scene(next) {
    scene.setScene(next);
    forgetPast();
    redraw();
  },
  past(scalars, from) {
    gaps.answered();
    const width = page.hello?.scalars.length ?? 0;
    for (let i = 0; width && i < scalars.length; i += width) {
      const row = scalars.slice(i, i + width);
      past.set(from ?? scalar("tick", row), row);
    }
    showBestLap();
    redraw();
  },
  text: got,
  file: saveFile,
  status(connected, attempts) {
    showConnection(connected, attempts);
    if (connected) page.state = undefined; // it may be that of another server
  },
};
page.link = isReplay ? new Player(handlers) : new Connection(handlers);
const seek = (tick: number) => send({ do: "seek", tick });

const chosen = (time: number) => seek(tickOf(time));
const charts = new Charts(get("charts"), { past, ghostPast, hovered: hover, chosen });
const options = new OptionsPane();
const inspect = new InspectPane();
const fork = new ForkBox();
const readout = new Readout();
const gaps = new Gaps();
const lanes = new Lanes(scene);
const fields = new ScenarioFields();
const controls = new Controls(scene);
const introduction = new Introduction(scene, () => setSplit(false));
const timeline = new Timeline(seek, (at) => hover(at && at * period()));
const evaluation = new EvaluationPane(() => {
  scene.marks = evaluation.marks();
  redraw();
});

function got(message: Text) {
  if (message.type === "hello") {
    const isOther = page.hello && String(page.hello.scalars) !== String(message.scalars);
    if (isOther) return location.reload(); // another server, which shows something else
    page.hello = message;
    if (!isReplay) past.most = ghostPast.most = Math.ceil(message.history_seconds / message.control_period);
    fields.offer(message);
    fillTerms();
    charts.describe(message);
    if (message.problem) showProblem(message.problem);
  } else if (message.type === "state") showState(message);
  else if (message.type === "options") {
    page.options = message;
    options.show();
    showAddress();
  } else if (message.type === "role") {
    showRole(message.drives);
    if (!message.drives) for (const key of [...wanted.keys()]) wanted.delete(key);
  } else if (message.type === "error") toast(message.message, true);
  else if (message.type === "note") toast(message.message);
  else if (message.type === "evaluation") {
    get("tab-evaluation").hidden = false;
    evaluation.show(message);
    showPane("evaluation");
    controls.setTool("pan");
    controls.setFollow("fit");
  }
}

/** Leaves only what a problem of the user's own has, instead of a car on a course. */
function showProblem(problem: NonNullable<Hello["problem"]>) {
  nameProblem(problem);
  wanted.forEach((_, key) => wanted.delete(key));
  controls.setTool("pan");
  scene.fit();
}

function showAddress() {
  if (!page.state || isReplay || wanted.size || page.hello?.problem) return;
  const address = addressOf(page.state);
  history.replaceState(null, "", `${location.pathname}${location.search}#${address}`);
}

function showState(next: State) {
  if (page.state && next.generation !== page.state.generation) forgetPast();
  if (isNew && next.introduction && !isReplay) {
    setSplit(true);
    introduction.open();
  }
  isNew = false;
  if (!next.introduction) introduction.end();
  if (!isReplay && next.paused) past.forgetAfter(next.newest);
  page.state = next;
  if (next.bounds) scene.setBounds(next.bounds);
  fields.show(next);
  showStatus(next);
  showTimeline();
  if (wanted.size) applyAddress(wanted);
  showAddress();
  evaluation.showState(next);
  showBestLap();
  redraw();
}

/** Shows car and ghost side by side, or in one picture. */
function setSplit(on: boolean) {
  scene.setSplit(on);
  press(get("split"), on);
  resize();
  showFrame(page.position);
}

function showTimeline() {
  const { state } = page;
  if (state) timeline.show(isReplay ? state.newest : Math.max(state.newest, past.newest));
}

/** Puts the cursor of the charts, the slider and the scene to a time (s). */
function hover(time: number | undefined) {
  const at = time === undefined || !page.state ? undefined : tickOf(time);
  const row = at === undefined ? undefined : past.at(at);
  charts.showCursor(time);
  timeline.showCursor(at);
  scene.probe = row && { x: scalar("x", row), y: scalar("y", row), yaw: scalar("yaw", row) };
  redraw();
}

/** Shows the best lap and the other figures, whenever a frame, a lap or late steps arrive. */
function showBestLap() {
  if (!page.frame || !page.hello) return;
  if (page.state) best.update(past);
  scene.best = best.at(scalar("lap_time"));
  readout.show(best);
}

function showFrame(at?: number) {
  const { frame } = page;
  if (!frame || !page.hello) return;
  const isPaused = page.state?.paused;
  const position = at ?? scalar("tick");
  page.position = position;
  if (!isReplay && !isPaused) for (const each of [past, ghostPast]) each.forgetAfter(position);
  past.set(position, frame.scalars);
  if (frame.ghostFrame) ghostPast.set(position, frame.ghostFrame.scalars);
  showBestLap();
  get("split").hidden = get("faint").hidden = !frame.ghostFrame;
  lanes.show(frame, position * period());
  introduction.show(frame);
  controls.showData(frame);
  inspect.update();
  if (!isPaused) showTimeline();
  redraw();
}

/** Lays the scene out for the size of the stage and what panels cover of it. */
function resize() {
  const stage = get("stage");
  const covered = coveredByPanels();
  const box = get("introduction");
  if (introduction.isOpen) covered.top = Math.max(covered.top, box.offsetTop + box.offsetHeight);
  scene.setStage(stage.clientWidth, stage.clientHeight, covered);
  redraw();
}
const resized = new ResizeObserver(resize);
for (const id of ["stage", "layers", "readout", "introduction"]) resized.observe(get(id));
resize();

function draw() {
  const { frame } = page;
  if (page.isDirty) {
    page.isDirty = false;
    if (!isReplay && page.state) gaps.fill(past);
    scene.driven = past.line(page.position);
    scene.ghostDriven = scene.isSideBySide ? ghostPast.line(page.position) : [];
    scene.chosen = inspect.chosen;
    scene.draw();
    lanes.place();
    charts.draw();
    const car = frame?.bodies[0];
    const ghost = scene.visible.has("ghost") ? frame?.ghost : undefined;
    place(get("label"), car, scene.camera);
    const isNear = car && ghost && Math.hypot(car.x - ghost.x, car.y - ghost.y) < 1.2;
    place(get("ghost-label"), ghost, scene.camera, isNear ? 1 : 0);
    showRuler(scene.camera);
    controls.showFollow();
    get("scale-low").textContent = scene.costRange[0].toPrecision(3);
    get("scale-high").textContent = scene.costRange[1].toPrecision(3);
  }
  page.link.drawn();
  requestAnimationFrame(draw);
}

function showTheme() {
  theme.apply();
  scene.theme = theme.now;
  charts.rebuild();
  redraw();
}

/** Shows the lap of the mark under a point of the map frame, or the candidate that passes there. */
function choose(x: number, y: number) {
  const mark = scene.markAt(evaluation.marks(), x, y);
  if (mark) evaluation.go(mark.lap, mark.contact);
  const candidate = mark || controls.tool !== "pan" ? -1 : scene.candidateAt(x, y);
  if (candidate >= 0) showPane("inspect");
  if (candidate >= 0 || inspect.chosen >= 0) inspect.choose(candidate);
  return mark !== undefined || candidate >= 0;
}
attachPointer(get<HTMLCanvasElement>("scene"), scene, () => controls.tool, choose);

const click = (id: string, act: () => void) => (get(id).onclick = act);
const help = () => get<HTMLDialogElement>("help-box").showModal();
const drive = attachDrive(() => !isReplay && page.hello && page.state && fork.open());
click("theme", () => {
  theme.toggle();
  showTheme();
});
click("help", help);
click("take-over", () => send({ do: "take_over" }));
click("split", () => {
  if (introduction.isOpen) introduction.end();
  else if (page.frame?.ghostFrame) setSplit(!scene.isSplit);
});
get("log").onchange = () => charts.setLog(get<HTMLInputElement>("log").checked);
click("zoom-out", () => charts.zoom());
click("earlier", () => charts.pan(-0.5));
click("later", () => charts.pan(0.5));
click("csv", () => download(`slalom-${page.state?.course}-${page.position}.csv`, charts.csv(), "text/csv"));
new Popover(get("scenario-open"), get("scenario"));
const showPane = attachPanes(document.querySelector("nav")!, (name) => {
  if (name === "charts") charts.rebuild();
  if (name === "inspect") inspect.show();
});
const menu = attachSaveMenu(scene);

function deleteSelected() {
  if (scene.selected > 0) send({ do: "remove", body: scene.selected });
  scene.selected = -1;
}
const arrows = {
  ArrowLeft: () => controls.move(1, 0),
  ArrowRight: () => controls.move(-1, 0),
  ArrowUp: () => controls.move(0, 1),
  ArrowDown: () => controls.move(0, -1),
};
const undoing = { "Ctrl z": () => send({ do: "undo" }), "Ctrl y": () => send({ do: "redo" }) };
const tools = (["disc", "box", "car", "pan"] as const).map((tool) => () => controls.setTool(tool));
const shortcuts: Shortcut[] = [
  ["Space", "pause and continue", { " ": drive.play }],
  [".", "one control step forward", { ".": drive.step }],
  [",", "one control step back", { ",": drive.back }],
  ["R", "restart from the beginning", { r: drive.restart }],
  ["F", "follow the car, heading up or not", { f: () => controls.follow() }],
  ["A", "fit the course", { a: () => controls.setFollow("fit") }],
  ["G", "car and ghost side by side, or in one picture", { g: () => get("split").click() }, true],
  ["← → ↑ ↓", "move the view", arrows],
  ["+ -", "zoom", { "+": () => controls.zoom(1.2), "-": () => controls.zoom(1 / 1.2) }],
  ["1 2 3 4", "pole, box, parked car, select", { 1: tools[0], 2: tools[1], 3: tools[2], 4: tools[3] }, true],
  ["[ ]", "push the car to its left or right", { "[": drive.left, "]": drive.right }, true],
  ["Delete", "delete the selected obstacle", { Delete: deleteSelected, Backspace: deleteSelected }, true],
  ["Ctrl Z, Ctrl Y", "undo and redo a change of options or obstacles", undoing, true],
  ["K", "fork from the control step shown", { k: drive.fork }, true],
  ["S", "save or share: picture, replay, recording, link", { s: () => menu.toggle() }],
  ["L", "layers", { l: () => get("layers").toggleAttribute("open") }],
  ["T", "dark or light", { t: () => get("theme").click() }],
  ["?", "this help", { "?": help }],
];
attachKeys(shortcuts);
returnFocus(get("scene"));

if (isReplay) {
  document.body.classList.add("replay");
  get("caption").hidden = false;
  get("option-list").inert = true;
  get("rate").querySelector('[value="0"]')?.remove();
}
get<HTMLDetailsElement>("layers").open = innerWidth >= 900;
scene.camera.zoom = scene.camera.drivingZoom;
showTheme();
controls.setTool(isReplay ? "pan" : "disc");
showPane("charts");
requestAnimationFrame(draw);

// For tests, and for debugging in the console.
const names = ["frame", "state", "hello"] as const;
const getters = names.map((name) => [name, { get: () => page[name] }]);
const figures = { scalar: (name: string) => scalar(name), waiting: () => page.link.waiting };
const known = { ...figures, replay: isReplay, scene, past, best, send, ask };
Object.assign(window, { slalom: Object.defineProperties(known, Object.fromEntries(getters)) });
