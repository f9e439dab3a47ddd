import "./style.css";
import { addressOf, applyAddress } from "./address";
import { BestLap } from "./best_lap";
import { Charts } from "./panes/charts";
import { Connection } from "./connection";
import { EvaluationPane } from "./panes/evaluation";
import { ScenarioFields } from "./fields";
import { ForkBox } from "./panes/fork";
import type { Link } from "./link";
import { attachPointer, type Tool } from "./scene/pointer";
import { Popover } from "./popover";
import { OptionsPane } from "./panes/options";
import { download, picture } from "./scene/picture";
import { Gaps, Past } from "./past";
import { Player, recordings } from "./player";
import { Introduction } from "./introduction";
import { Lanes } from "./scene/lanes";
import { foldHeader, help, layout } from "./layout";
import type { Frame, Hello, Scene, State, Text } from "./protocol";
import { PresetBox } from "./panes/preset";
import { Readout } from "./readout";
import { Restore } from "./restore";
import { showStatus } from "./status";
import { Timeline } from "./timeline";
import { copy, toast } from "./toast";
import { press, Views } from "./scene/views";
import { attachKeys, attachTabs, returnFocus } from "./keys";
import { coveredBy, place, showRuler } from "./scene/overlay";
import { terms, type Layer, type Term } from "./scene/layers";
import { SceneView } from "./scene/scene";
import { Themes } from "./theme";

layout(document.getElementById("app")!);
const get = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;

let hello: Hello | undefined;
let state: State | undefined;
let frame: Frame | undefined;
let dirty = true;
/** Where the frame that is shown stands in the past. */
let position = 0;

/** The scenario in the address that is still to be set. */
const wanted = new URLSearchParams(location.hash.slice(1));
let isNew = wanted.size === 0; // whether nobody has told this page what to show
const theme = new Themes();
const scene = new SceneView(get<HTMLCanvasElement>("scene"), theme.now);
const past = new Past(Infinity), ghostPast = new Past(Infinity);
const best = new BestLap();
const charts = new Charts(get("charts"), { past, hovered: hover, chosen: (time) => state && send({ do: "seek", tick: Math.round(time / state.control_period) }) });
const scalar = (name: string) => (frame && hello ? frame.scalars[hello.scalars.indexOf(name)] : NaN);

const handlers = {
  frame(next: Frame, at?: number) { frame = next; showFrame(at); },
  scene(next: Scene) { scene.setScene(next); views.minimap.setScene(next); past.clear(); ghostPast.clear(); charts.clear(); best.forget(); dirty = true; },
  past(scalars: Float64Array, from?: number) {
    gaps.answered();
    const width = hello?.scalars.length ?? 0;
    for (let i = 0; width && i < scalars.length; i += width) {
      const row = scalars.slice(i, i + width);
      past.set(from ?? row[hello!.scalars.indexOf("tick")], row);
    }
    showBestLap();
    dirty = true;
  },
  text: got,
  file(name: string, content: Uint8Array) { download(name, content as BlobPart, name.endsWith(".html") ? "text/html" : "application/octet-stream"); toast(`Saved ${name}, ${(content.length / 1e6).toFixed(1)} MB.`); },
  status(connected: boolean, attempts: number) {
    get("lost").hidden = connected || attempts === 0;
    get("lost-text").textContent = `Reconnecting … (attempt ${attempts}). The drive continues without this page.`;
    get("connection").className = "pill" + (connected ? "" : " bad");
    get("connection-text").textContent = connected ? "connected" : "connection lost";
    if (connected) state = undefined; // it may be that of another server
  },
};
const recorded = recordings(), isReplay = recorded.length > 0;
const link: Link = isReplay ? new Player(handlers, recorded) : new Connection(handlers);
const send = (command: Record<string, unknown>) => link.send(command);
const preset = new PresetBox(get<HTMLDialogElement>("preset-box"), async ({ base, set }) => {
  if (base && base !== state?.config) await link.ask({ do: "scenario", config: base });
  await link.ask({ do: "preset", set });
});
const options = new OptionsPane(get("options"), send, { copy, save: (yaml) => download(`slalom-${state?.config}-preset.yaml`, yaml, "text/yaml"), load: () => preset.open() });
const fork = new ForkBox(get<HTMLDialogElement>("fork-box"), (command) => link.ask(command));
const readout = new Readout(), gaps = new Gaps(send), lanes = new Lanes(scene);
const fields = new ScenarioFields(send, (command) => link.ask(command));
const introduction = new Introduction(() => send({ do: "restart" }), () => views.setSplit(false));
const views = new Views(scene, introduction, () => { resize(); showFrame(position); });
const timeline = new Timeline(isReplay, (tick) => send({ do: "seek", tick }), (at) => hover(at === undefined || !state ? undefined : at * state.control_period));
const restore = new Restore((address) => state && applyAddress(new URLSearchParams(address), state, changedOptions, send), () => showAddress());
const evaluation = new EvaluationPane(get("evaluation"), send, () => { scene.marks = evaluation.marks(); dirty = true; });

function got(message: Text) {
  if (message.type === "hello") {
    hello = message;
    if (!isReplay) { past.most = ghostPast.most = Math.ceil(message.history_seconds / message.control_period); restore.greeted(message.session, wanted.size ? "" : location.hash.slice(1)); }
    scene.hello = message;
    fields.offer(message);
  } else if (message.type === "state") showState(message);
  else if (message.type === "options") { options.show(message); fork.takeOptions(message); changedOptions = message.changed; showAddress(); }
  else if (message.type === "error") toast(message.message, true);
  else if (message.type === "note") toast(message.message);
  else if (message.type === "evaluation") {
    document.querySelector<HTMLElement>('[data-pane="evaluation"]')!.hidden = false;
    evaluation.show(message);
    showPane("evaluation");
    setTool("pan");
    setFollow("fit");
  }
}

let changedOptions: string[] = [];

function showAddress() {
  if (!state || isReplay || wanted.size) return;
  const address = addressOf(state, changedOptions);
  restore.showServer(address);
  if (!restore.isOpen) history.replaceState(null, "", `${location.pathname}${location.search}#${address}`);
}

function showState(next: State) {
  if (state && next.generation !== state.generation) { past.clear(); ghostPast.clear(); best.forget(); }
  if (isNew && next.introduction && !isReplay) views.introduce();
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
  dirty = true;
}

const newest = () => (isReplay ? state!.newest : Math.max(state!.newest, past.newest));
function showTimeline() {
  if (state) timeline.show(state, newest(), scalar("time"));
}

/** Puts the cursor of the charts, the slider and the scene to a time (s). */
function hover(time: number | undefined) {
  const at = time === undefined || !state ? undefined : Math.round(time / state.control_period), row = at === undefined ? undefined : past.at(at);
  charts.showCursor(time);
  timeline.showCursor(at);
  const of = (name: string) => row![hello!.scalars.indexOf(name)];
  scene.probe = row && { x: of("x"), y: of("y"), yaw: of("yaw") };
  dirty = true;
}

/** The best lap, the car's time behind it, and the other figures: whenever a frame, a lap or late steps arrive. */
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
  charts.show(frame, hello, position, state?.control_period ?? hello.control_period);
  showBestLap();
  get("split").hidden = !frame.ghostFrame;
  lanes.show(frame, hello, position * (state?.control_period ?? hello.control_period));
  introduction.show(frame, hello);
  if (!state?.paused) showTimeline();
  dirty = true;
}

/** A driven line: as far as the past is known, to the step that is shown. */
function drivenLine(past: Past): number[] {
  if (!hello) return [];
  const x = hello.scalars.indexOf("x"), y = hello.scalars.indexOf("y"), line: number[] = [];
  for (let i = past.oldest; i <= position; ++i) {
    const row = past.at(i), n = line.length;
    if (!row) continue;
    if (n && Math.hypot(row[x] - line[n - 2], row[y] - line[n - 1]) > 2) line.length = 0; // the car was put elsewhere
    line.push(row[x], row[y]);
  }
  return line;
}

/** The size of the stage, and what panels cover of it. A fitted course stays fitted. */
function resize() {
  const stage = get("stage"), covered = coveredBy(stage, get<HTMLDetailsElement>("layers"), get("readout"));
  if (introduction.isOpen) covered.top = Math.max(covered.top, get("introduction").offsetTop + get("introduction").offsetHeight);
  scene.setStage(stage.clientWidth, stage.clientHeight, covered);
  dirty = true;
}
const resized = new ResizeObserver(resize);
for (const id of ["stage", "layers", "readout", "introduction"]) resized.observe(get(id));
resize();

function draw() {
  if (dirty) {
    dirty = false;
    if (!isReplay && state) gaps.fill(past, state);
    scene.driven = drivenLine(past);
    scene.ghostDriven = scene.isSideBySide ? drivenLine(ghostPast) : [];
    scene.draw();
    lanes.place();
    views.showMinimap(theme.now);
    charts.draw();
    const car = frame?.bodies[0], ghost = scene.visible.has("ghost") ? frame?.ghost : undefined;
    place(get("label"), car, scene.camera);
    const near = car && ghost && Math.hypot(car.x - ghost.x, car.y - ghost.y) < 1.2;
    place(get("ghost-label"), ghost, scene.camera, near ? 1 : 0);
    showRuler(scene.camera, get("ruler-text"), get("ruler-bar"));
    showFollow();
    const [low, high] = scene.costRange;
    get("scale-low").textContent = low.toPrecision(3);
    get("scale-high").textContent = high.toPrecision(3);
  }
  link.drawn();
  requestAnimationFrame(draw);
}

function showTheme() {
  theme.apply();
  scene.theme = theme.now;
  charts.rebuild();
  dirty = true;
}
let tool: Tool = "disc";
function setTool(next: Tool) {
  tool = next;
  for (const b of document.querySelectorAll<HTMLElement>("[data-tool]")) press(b, b.dataset.tool === next);
}
function setFollow(next: "free" | "follow" | "heading" | "fit") {
  if (next === "fit") scene.fit();
  else scene.camera.follow = next;
  dirty = true;
}
function showFollow() {
  const now = scene.isFitted ? "fit" : scene.camera.follow;
  for (const b of document.querySelectorAll<HTMLElement>("[data-follow]")) if ((b.ariaPressed === "true") !== (b.dataset.follow === now) || !b.ariaPressed) press(b, b.dataset.follow === now);
}

function clicked(x: number, y: number) {
  const mark = scene.markAt(evaluation.marks(), x, y);
  if (mark) evaluation.go(mark.lap, mark.contact);
  return mark !== undefined;
}
attachPointer({ canvas: get<HTMLCanvasElement>("scene"), scene, send, tool: () => tool, redraw: () => (dirty = true), clicked, fixed: isReplay });

// Controls.
const click = (id: string, act: () => void) => (get(id).onclick = act);
// A slow browser shows an earlier tick than the server has reached; the pause holds at what is shown.
const play = () => send(state?.paused ? { do: "play" } : { do: "pause", ...(scene.frame ? { tick: scalar("tick") } : {}) });
click("play", play);
click("step", () => send({ do: "step" }));
click("restart", () => send({ do: "restart" }));
const openFork = () => { if (isReplay || !hello || !state) return; if (!state.paused) send({ do: "pause" }); fork.open(hello, state); };
click("fork", openFork);
click("theme", () => { theme.toggle(); showTheme(); });
click("help", () => get<HTMLDialogElement>("help-box").showModal());
const menu = new Popover(get("save-open"), get("save"));
new Popover(get("scenario-open"), get("scenario"));
foldHeader();
const save = (id: string, act: () => void) => click(id, () => { menu.close(); act(); });
save("save-picture", () => { scene.draw(); void picture(get<HTMLCanvasElement>("scene"), get("stage")).then((blob) => download(`slalom-${state?.course}-${state?.tick}.png`, blob, "image/png")); });
save("save-replay", () => { if (!isReplay) { toast("Saving a replay of the last minute …"); send({ do: "save", what: "replay" }); } else void fetch(location.href).then((r) => r.text()).then((text) => download("slalom-replay.html", text, "text/html"), () => toast("This page is the replay; it is already on your disk.")); });
save("save-recording", () => { toast("Saving a recording of the last minute …"); send({ do: "save", what: "recording" }); });
save("save-link", () => copy(location.href, "a link"));
click("csv", () => download(`slalom-${state?.course}-${position}.csv`, charts.csv(), "text/csv"));
click("nudge-left", () => send({ do: "nudge", left: 0.15 }));
click("nudge-right", () => send({ do: "nudge", left: -0.15 }));
for (const b of document.querySelectorAll<HTMLElement>("[data-tool]")) b.onclick = () => setTool(b.dataset.tool as Tool);
for (const b of document.querySelectorAll<HTMLElement>("[data-follow]")) b.onclick = () => setFollow(b.dataset.follow as "follow");
attachTabs(document.querySelector("nav")!, showPane);
for (const box of document.querySelectorAll<HTMLInputElement>("[data-layer]"))
  box.onchange = () => { const name = box.dataset.layer as Layer; if (box.checked) scene.visible.add(name); else scene.visible.delete(name); dirty = true; };
get<HTMLSelectElement>("term").onchange = () => { scene.term = get<HTMLSelectElement>("term").value as Term; dirty = true; };

function showPane(name: string) {
  for (const b of document.querySelectorAll<HTMLElement>("nav button")) {
    const shown = b.dataset.pane === name;
    b.classList.toggle("on", shown);
    b.setAttribute("aria-selected", String(shown));
    b.tabIndex = shown ? 0 : -1;
  }
  for (const p of document.querySelectorAll<HTMLElement>(".pane")) p.hidden = p.id !== "pane-" + name;
  if (name === "charts") charts.rebuild();
}

const stride = 40; // pixels of an arrow key
const move = (act: () => void) => { act(); dirty = true; };
const keys: Record<string, () => void> = {
  " ": play,
  ".": () => send({ do: "step" }),
  ",": () => state && send({ do: "seek", tick: (state.paused ? state.tick : state.newest) - 1 }),
  "[": () => send({ do: "nudge", left: 0.15 }),
  "]": () => send({ do: "nudge", left: -0.15 }),
  r: () => send({ do: "restart" }),
  f: () => setFollow(scene.camera.follow === "follow" ? "heading" : "follow"),
  a: () => setFollow("fit"),
  "1": () => setTool("disc"), "2": () => setTool("box"), "3": () => setTool("car"), "4": () => setTool("pan"),
  g: () => get("split").click(),
  c: () => get("space").click(),
  "+": () => move(() => scene.zoom(1.2)), "-": () => move(() => scene.zoom(1 / 1.2)),
  ArrowLeft: () => move(() => scene.drag(stride, 0)), ArrowRight: () => move(() => scene.drag(-stride, 0)), ArrowUp: () => move(() => scene.drag(0, stride)), ArrowDown: () => move(() => scene.drag(0, -stride)),
  k: openFork,
  s: () => menu.toggle(),
  t: () => get("theme").click(),
  l: () => { get<HTMLDetailsElement>("layers").open = !get<HTMLDetailsElement>("layers").open; },
  "?": () => get<HTMLDialogElement>("help-box").showModal(),
  Delete: () => { if (scene.selected > 0) send({ do: "remove", body: scene.selected }); scene.selected = -1; },
  Backspace: () => keys.Delete(),
};
attachKeys(keys, () => send({ do: "undo" }), () => send({ do: "redo" }));
returnFocus(get("scene"));

help(get("help-box"));
get<HTMLSelectElement>("term").append(...terms.map((t) => new Option(t === "total" ? "Total cost" : t[0].toUpperCase() + t.slice(1) + " cost", t, t === "total", t === "total")));
if (isReplay) {
  document.body.classList.add("replay");
  get("caption").hidden = false;
  get("option-list").inert = true;
  get<HTMLSelectElement>("rate").querySelector('[value="0"]')?.remove();
}
if (innerWidth < 900) get<HTMLDetailsElement>("layers").open = false;
if (innerWidth < 900) scene.camera.zoom = innerWidth < 480 ? 32 : 42;
showTheme();
setTool(isReplay ? "pan" : "disc");
showPane("charts");
requestAnimationFrame(draw);

// The state of the page, for tests and for debugging in the console.
Object.assign(window, { slalom: { get frame() { return frame; }, get state() { return state; }, get hello() { return hello; }, get received() { return link.received; }, get waiting() { return link.waiting; }, replay: isReplay, scalar, scene, past, best, send } });
