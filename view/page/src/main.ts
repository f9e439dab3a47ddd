import "./style.css";
import { addressOf, applyAddress } from "./address";
import { BestLap } from "./best_lap";
import { Connection } from "./connection";
import { Controls } from "./controls";
import { get, press } from "./dom";
import { attachDrive } from "./drive";
import { ScenarioFields } from "./fields";
import { Introduction } from "./introduction";
import { attachKeys, attachPanes, returnFocus } from "./keys";
import { fillLists, foldHeader } from "./layout";
import type { Handlers, Link } from "./link";
import { Charts } from "./panes/charts";
import { EvaluationPane } from "./panes/evaluation";
import { ForkBox } from "./panes/fork";
import { OptionsPane } from "./panes/options";
import { Gaps, Past } from "./past";
import { Player, recordings } from "./player";
import { Popover } from "./popover";
import type { Frame, Hello, State, Text } from "./protocol";
import { Readout } from "./readout";
import { attachSaveMenu, saveFile } from "./save";
import { Lanes } from "./scene/lanes";
import { coveredBy, place, showRuler } from "./scene/overlay";
import { attachPointer } from "./scene/pointer";
import { SceneView } from "./scene/scene";
import { showConnection, showRole, showStatus } from "./status";
import { Themes } from "./theme";
import { Timeline } from "./timeline";
import { download, toast } from "./toast";

fillLists();
foldHeader();

let hello: Hello | undefined;
let state: State | undefined;
let frame: Frame | undefined;
let position = 0; // number of the shown frame, in the past
let dirty = true; // the page is to be drawn again
let changedOptions: string[] = [];

const wanted = new URLSearchParams(location.hash.slice(1)); // scenario in the address, still to be set
let isNew = wanted.size === 0; // whether nobody has told this page what to show
const theme = new Themes();
const scene = new SceneView(get<HTMLCanvasElement>("scene"), theme.now);
const past = new Past(Infinity);
const ghostPast = new Past(Infinity);
const best = new BestLap();
const tickOf = (time: number) => Math.round(time / (state?.control_period ?? 1));
const scalar = (name: string) => (frame && hello ? frame.scalars[hello.scalars.indexOf(name)] : NaN);
const redraw = () => (dirty = true);

function forgetPast() {
  past.clear();
  ghostPast.clear();
  best.forget();
}

const handlers: Handlers = {
  frame(next, at) {
    frame = next;
    showFrame(at);
  },
  scene(next) {
    scene.setScene(next);
    forgetPast();
    charts.clear();
    redraw();
  },
  past(scalars, from) {
    gaps.answered();
    const width = hello?.scalars.length ?? 0;
    for (let i = 0; width && i < scalars.length; i += width) {
      const row = scalars.slice(i, i + width);
      past.set(from ?? row[hello!.scalars.indexOf("tick")], row);
    }
    showBestLap();
    redraw();
  },
  text: got,
  file: saveFile,
  status(connected, attempts) {
    showConnection(connected, attempts);
    if (connected) state = undefined; // it may be that of another server
  },
};
const recorded = recordings();
const isReplay = recorded.length > 0;
const link: Link = isReplay ? new Player(handlers, recorded) : new Connection(handlers);
const send = (command: Record<string, unknown>) => link.send(command);
const ask = (command: Record<string, unknown>) => link.ask(command);
const seek = (tick: number) => send({ do: "seek", tick });

const charts = new Charts(get("charts"), { past, hovered: hover, chosen: (time) => seek(tickOf(time)) });
const options = new OptionsPane(send);
const fork = new ForkBox(ask);
const readout = new Readout();
const gaps = new Gaps(send);
const lanes = new Lanes(scene);
const fields = new ScenarioFields(send, ask);
const controls = new Controls(scene, redraw);
const introduction = new Introduction(
  () => send({ do: "restart" }),
  () => setSplit(false),
);
const timeline = new Timeline(isReplay, seek, (at) =>
  hover(at === undefined || !state ? undefined : at * state.control_period),
);
const evaluation = new EvaluationPane(send, () => {
  scene.marks = evaluation.marks();
  redraw();
});

function got(message: Text) {
  if (message.type === "hello") {
    hello = message;
    if (!isReplay) past.most = ghostPast.most = Math.ceil(message.history_seconds / message.control_period);
    scene.hello = message;
    fields.offer(message);
  } else if (message.type === "state") showState(message);
  else if (message.type === "options") {
    options.show(message);
    fork.takeOptions(message);
    changedOptions = message.changed;
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

function showAddress() {
  if (!state || isReplay || wanted.size) return;
  const address = addressOf(state, changedOptions);
  history.replaceState(null, "", `${location.pathname}${location.search}#${address}`);
}

function showState(next: State) {
  if (state && next.generation !== state.generation) forgetPast();
  if (isNew && next.introduction && !isReplay) {
    setSplit(true);
    introduction.open(scene.camera);
  }
  isNew = false;
  if (!next.introduction) introduction.end();
  if (!isReplay && next.paused) past.forgetAfter(next.newest);
  state = next;
  fields.show(next);
  showStatus(next, isReplay);
  showTimeline();
  if (wanted.size) applyAddress(wanted, next, changedOptions, send);
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
  showFrame(position);
}

function showTimeline() {
  if (!state) return;
  timeline.show(state, isReplay ? state.newest : Math.max(state.newest, past.newest), scalar("time"));
}

/** Puts the cursor of the charts, the slider and the scene to a time (s). */
function hover(time: number | undefined) {
  const at = time === undefined || !state ? undefined : tickOf(time);
  const row = at === undefined ? undefined : past.at(at);
  charts.showCursor(time);
  timeline.showCursor(at);
  const of = (name: string) => row![hello!.scalars.indexOf(name)];
  scene.probe = row && { x: of("x"), y: of("y"), yaw: of("yaw") };
  redraw();
}

/** Shows the best lap and the other figures, whenever a frame, a lap or late steps arrive. */
function showBestLap() {
  if (!frame || !hello) return;
  if (state) best.update(state, past, hello.scalars);
  scene.best = best.at(scalar("lap_time"));
  readout.show(frame, hello, state, best);
}

function showFrame(at?: number) {
  if (!frame || !hello) return;
  position = at ?? scalar("tick");
  if (!isReplay && !state?.paused) for (const each of [past, ghostPast]) each.forgetAfter(position);
  past.set(position, frame.scalars);
  if (frame.ghostFrame) ghostPast.set(position, frame.ghostFrame.scalars);
  scene.frame = frame;
  const period = state?.control_period ?? hello.control_period;
  charts.show(frame, hello, position, period);
  showBestLap();
  get("split").hidden = !frame.ghostFrame;
  lanes.show(frame, hello, position * period);
  introduction.show(frame, hello);
  if (!state?.paused) showTimeline();
  redraw();
}

/** Lays the scene out for the size of the stage and what panels cover of it. */
function resize() {
  const stage = get("stage");
  const covered = coveredBy(stage, get<HTMLDetailsElement>("layers"), get("readout"));
  const box = get("introduction");
  if (introduction.isOpen) covered.top = Math.max(covered.top, box.offsetTop + box.offsetHeight);
  scene.setStage(stage.clientWidth, stage.clientHeight, covered);
  redraw();
}
const resized = new ResizeObserver(resize);
for (const id of ["stage", "layers", "readout", "introduction"]) resized.observe(get(id));
resize();

function draw() {
  if (dirty) {
    dirty = false;
    if (!isReplay && state) gaps.fill(past, state);
    const scalars = hello?.scalars ?? [];
    scene.driven = past.line(scalars, position);
    scene.ghostDriven = scene.isSideBySide ? ghostPast.line(scalars, position) : [];
    scene.draw();
    lanes.place();
    charts.draw();
    const car = frame?.bodies[0];
    const ghost = scene.visible.has("ghost") ? frame?.ghost : undefined;
    place(get("label"), car, scene.camera);
    const isNear = car && ghost && Math.hypot(car.x - ghost.x, car.y - ghost.y) < 1.2;
    place(get("ghost-label"), ghost, scene.camera, isNear ? 1 : 0);
    showRuler(scene.camera, get("ruler-text"), get("ruler-bar"));
    controls.showFollow();
    get("scale-low").textContent = scene.costRange[0].toPrecision(3);
    get("scale-high").textContent = scene.costRange[1].toPrecision(3);
  }
  link.drawn();
  requestAnimationFrame(draw);
}

function showTheme() {
  theme.apply();
  scene.theme = theme.now;
  charts.rebuild();
  redraw();
}

/** Shows the lap of the mark under a point of the map frame, if there is one. */
function chooseMark(x: number, y: number) {
  const mark = scene.markAt(evaluation.marks(), x, y);
  if (mark) evaluation.go(mark.lap, mark.contact);
  return mark !== undefined;
}
attachPointer({
  canvas: get<HTMLCanvasElement>("scene"),
  scene,
  send,
  tool: () => controls.tool,
  redraw,
  clicked: chooseMark,
  fixed: isReplay,
});

const click = (id: string, act: () => void) => (get(id).onclick = act);
const help = () => get<HTMLDialogElement>("help-box").showModal();
const driveKeys = attachDrive({
  send,
  state: () => state,
  shown: () => (frame ? scalar("tick") : undefined),
  fork: () => !isReplay && hello && state && fork.open(hello, state),
});
click("theme", () => {
  theme.toggle();
  showTheme();
});
click("help", help);
click("take-over", () => send({ do: "take_over" }));
click("split", () => {
  if (introduction.isOpen) introduction.end();
  else if (frame?.ghostFrame) setSplit(!scene.isSplit);
});
click("csv", () => download(`slalom-${state?.course}-${position}.csv`, charts.csv(), "text/csv"));
new Popover(get("scenario-open"), get("scenario"));
const showPane = attachPanes(document.querySelector("nav")!, (name) => name === "charts" && charts.rebuild());
const menu = attachSaveMenu(
  send,
  () => scene.draw(),
  () => state,
);

function deleteSelected() {
  if (scene.selected > 0) send({ do: "remove", body: scene.selected });
  scene.selected = -1;
}
const keys: Record<string, () => void> = {
  ...controls.keys,
  ...driveKeys,
  g: () => get("split").click(),
  s: () => menu.toggle(),
  t: () => get("theme").click(),
  "?": help,
  Delete: deleteSelected,
  Backspace: deleteSelected,
};
attachKeys(
  keys,
  () => send({ do: "undo" }),
  () => send({ do: "redo" }),
);
returnFocus(get("scene"));

if (isReplay) {
  document.body.classList.add("replay");
  get("caption").hidden = false;
  get("option-list").inert = true;
  get("rate").querySelector('[value="0"]')?.remove();
}
get<HTMLDetailsElement>("layers").open = innerWidth >= 900;
if (innerWidth < 900) scene.camera.zoom = innerWidth < 480 ? 32 : 42;
showTheme();
controls.setTool(isReplay ? "pan" : "disc");
showPane("charts");
requestAnimationFrame(draw);

// The state of the page, for tests and for debugging in the console.
const inside = {
  frame: () => frame,
  state: () => state,
  hello: () => hello,
  received: () => link.received,
  waiting: () => link.waiting,
};
const properties = Object.entries(inside).map(([name, get]) => [name, { get }]);
const known = { replay: isReplay, scalar, scene, past, best, send };
Object.assign(window, { slalom: Object.defineProperties(known, Object.fromEntries(properties)) });
