import "./style.css";
import { Charts } from "./charts";
import { Connection } from "./connection";
import { attachPointer, type Tool } from "./pointer";
import { OptionsPane } from "./options";
import { layout, help } from "./layout";
import { rampCss, themes } from "./palette";
import type { Frame, Hello, State, Text } from "./protocol";
import { layers, SceneView, terms, type Layer, type Term } from "./scene";

layout(document.getElementById("app")!);
const get = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;

let hello: Hello | undefined;
let state: State | undefined;
let frame: Frame | undefined;
let dirty = true;
let scrubbing = false;

const wanted = new URLSearchParams(location.hash.slice(1));
let themeName: "dark" | "light" = (localStorage.getItem("slalom-theme") as "dark" | "light" | null) ?? (matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark");
const scene = new SceneView(get<HTMLCanvasElement>("scene"), themes[themeName]);
const charts = new Charts(get("charts"));
const scalar = (name: string) => (frame && hello ? frame.scalars[hello.scalars.indexOf(name)] : NaN);

const connection = new Connection({
  frame(next) { frame = next; showFrame(); },
  scene(next) { scene.setScene(next); charts.clear(); dirty = true; },
  text: got,
  status(connected, attempts) {
    get("lost").hidden = connected || attempts === 0;
    get("lost-text").textContent = `Trying again … (attempt ${attempts}). The drive goes on without this page; nothing is lost but what it showed.`;
    get("connection").className = "pill" + (connected ? "" : " bad");
    get("connection-text").textContent = connected ? "connected" : "connection lost";
    if (connected) document.title = "Slalom";
  },
});
const send = (command: Record<string, unknown>) => connection.send(command);
const options = new OptionsPane(get("options"), send, copy);

function toast(message: string, bad = false) {
  const box = get("toast");
  box.textContent = message;
  box.className = "card" + (bad ? " bad" : "");
  box.hidden = false;
  clearTimeout(toastTimer);
  toastTimer = window.setTimeout(() => (box.hidden = true), bad ? 6000 : 2500);
}
let toastTimer = 0;

function copy(text: string, what: string) {
  navigator.clipboard?.writeText(text).then(() => toast(`Copied as ${what}.`), () => toast(text));
}

function got(message: Text) {
  if (message.type === "hello") {
    hello = message;
    scene.hello = message;
    fill("course", message.courses);
    fill("method", message.methods);
    fill("config", message.configurations);
    fill("ghost", ["", ...message.methods], "no ghost");
    obeyAddress();
  } else if (message.type === "state") showState(message);
  else if (message.type === "options") options.show(message);
  else if (message.type === "error") toast(message.message, true);
}

function fill(id: string, names: string[], none = "") {
  const select = get<HTMLSelectElement>(id);
  select.replaceChildren(...names.map((n) => new Option(n || none, n)));
}
function choose(id: string, value: string) {
  const select = get<HTMLSelectElement>(id);
  if (![...select.options].some((o) => o.value === value)) select.append(new Option(value, value));
  if (document.activeElement !== select) select.value = value;
}

/** The address holds the scenario: #course=stag&method=mppi&seed=3. */
function obeyAddress() {
  const scenario: Record<string, unknown> = {};
  for (const key of ["course", "method", "config", "seed"]) if (wanted.has(key)) scenario[key] = wanted.get(key);
  if (wanted.has("obstacles")) scenario.obstacles = Number(wanted.get("obstacles"));
  for (const key of [...wanted.keys()]) wanted.delete(key);
  if (Object.keys(scenario).length) send({ do: "scenario", ...scenario });
}

function showState(next: State) {
  if (state && next.generation !== state.generation) charts.clear();
  state = next;
  choose("course", next.course);
  choose("method", next.method);
  choose("config", next.config);
  choose("ghost", next.ghost);
  for (const [id, value] of [["seed", next.seed], ["obstacles", String(next.obstacles)]]) {
    const input = get<HTMLInputElement>(id);
    if (document.activeElement !== input) input.value = value;
  }
  const past = next.tick < next.newest;
  get("play").textContent = next.paused ? "▶ Play" : "❚❚ Pause";
  get("play").classList.toggle("primary", next.paused);
  get("fork").hidden = !next.paused;
  const mode = get("mode");
  mode.className = "pill" + (next.paused ? " warn" : "");
  get("mode-text").textContent = (next.real_time ? "real time" : "lockstep") + (next.paused ? (past ? " · in the past" : " · paused") : next.rate === 0 ? " · as fast as it goes" : next.rate !== 1 ? ` · ${next.rate}×` : "");
  mode.title = next.real_time ? "Commands take effect by the wall-clock time the planner took, as on a car" : "Time stands still while the planner works: the same seed gives the same drive on any machine";
  get<HTMLSelectElement>("rate").value = String(next.rate);
  get("real-time").classList.toggle("on", next.real_time);
  showTimeline();
  const best = Math.min(...next.laps.map((l) => l.time));
  get("laps").innerHTML = next.laps.length
    ? `<table><thead><tr><th>Lap</th><th>Method</th><th class="n">Time, s</th><th class="n">Contacts</th></tr></thead><tbody>${[...next.laps].reverse().map((l) => `<tr class="${l.time === best ? "best" : ""}"><td>${l.lap}</td><td>${l.method}</td><td class="n">${l.time.toFixed(2)}</td><td class="n">${l.contacts}</td></tr>`).join("")}</tbody></table>`
    : "<p>No lap is complete yet.</p>";
  get("about").textContent = `${next.description} ${next.length.toFixed(1)} m, ${next.evaluation === "published" ? "evaluated as the published program" : "true physics"}${next.edited ? ", changed by hand" : ""}.`;
  history.replaceState(null, "", `${location.pathname}${location.search}#course=${next.course}&method=${next.method}&config=${next.config}&seed=${next.seed}&obstacles=${next.obstacles}`);
  dirty = true;
}

function showTimeline() {
  if (!state) return;
  const slider = get<HTMLInputElement>("timeline"), newest = Math.max(state.newest, scalar("tick") || 0);
  slider.min = String(Math.max(0, state.oldest));
  slider.max = String(Math.max(1, newest));
  const tick = state.paused ? state.tick : newest;
  if (!scrubbing) slider.value = String(tick);
  const back = (newest - Number(slider.value)) * state.control_period;
  get("time").textContent = back > 1e-6 ? `−${back.toFixed(2)} s` : `${(scalar("time") || 0).toFixed(2)} s`;
}

function showFrame() {
  if (!frame || !hello) return;
  scene.setFrame(frame, scalar("tick"), scalar("x"), scalar("y"));
  charts.add(frame, hello);
  const n = (name: string, digits: number) => { const v = scalar(name); return Number.isFinite(v) ? v.toFixed(digits) : "–"; };
  const status = hello.statuses[scalar("status")] ?? "";
  get("speed").firstChild!.textContent = n("speed", 1);
  get("lap-time").firstChild!.textContent = n("lap_time", 1);
  get("lap-number").textContent = `lap ${scalar("lap") + 1}`;
  get("clearance").firstChild!.textContent = n("clearance", 2);
  get("solve").firstChild!.textContent = n("tick_ms", 2);
  get("contacts").textContent = n("contacts", 0);
  const label = get("label");
  label.textContent = `${hello.methods[scalar("method")] ?? ""}${status && status !== "ok" ? " · " + status.replace(/_/g, " ") : ""}`;
  label.classList.toggle("blocked", status === "blocked");
  if (!state?.paused) showTimeline();
  dirty = true;
}

function resize() {
  const stage = get("stage");
  scene.camera.width = stage.clientWidth;
  scene.camera.height = stage.clientHeight;
  dirty = true;
}
new ResizeObserver(resize).observe(get("stage"));
resize();

function draw() {
  if (dirty) {
    dirty = false;
    scene.draw();
    charts.draw();
    const car = frame?.bodies[0], label = get("label");
    label.hidden = !car;
    if (car) {
      const [x, y] = scene.camera.toScreen(car.x, car.y);
      label.style.transform = `translate(${Math.round(x - label.offsetWidth / 2)}px, ${Math.round(y + 0.34 * scene.camera.zoom + 8)}px)`;
    }
    const metres = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20].find((m) => m * scene.camera.zoom >= 48) ?? 20;
    get("ruler-text").textContent = metres + " m";
    get("ruler-bar").style.width = metres * scene.camera.zoom + "px";
    const [low, high] = scene.costRange;
    get("scale-low").textContent = low.toPrecision(3);
    get("scale-high").textContent = high.toPrecision(3);
  }
  requestAnimationFrame(draw);
}

function setTheme(name: "dark" | "light") {
  themeName = name;
  document.documentElement.dataset.theme = name;
  scene.theme = themes[name];
  get("ramp").style.background = rampCss(themes[name]);
  for (const [layer] of layers) {
    const swatch = document.querySelector<HTMLElement>(`[data-swatch="${layer}"]`), t = themes[name];
    const colour = { costMap: t.cost, path: t.path, scan: t.scan, candidates: undefined, guides: t.guide, nominal: t.nominal, plan: t.plan, spread: t.spread, driven: t.driven }[layer];
    if (swatch) swatch.style.background = colour ? `rgb(${colour.slice(0, 3).map((v) => Math.round(255 * v)).join(" ")} / ${Math.max(0.45, colour[3])})` : rampCss(t);
  }
  charts.rebuild();
  dirty = true;
}

let tool: Tool = "disc";
function setTool(next: Tool) {
  tool = next;
  for (const b of document.querySelectorAll<HTMLElement>("[data-tool]")) b.classList.toggle("on", b.dataset.tool === next);
}
function setFollow(next: "free" | "follow" | "heading" | "fit") {
  if (next === "fit") scene.fit();
  else scene.camera.follow = next;
  dirty = true;
}

attachPointer({ canvas: get<HTMLCanvasElement>("scene"), scene, send, tool: () => tool, redraw: () => (dirty = true) });

// Controls.
const click = (id: string, act: () => void) => (get(id).onclick = act);
const scenario = (key: string) => (get<HTMLInputElement>(key).onchange = () => { const value = get<HTMLInputElement>(key).value; send({ do: "scenario", [key]: key === "obstacles" ? Number(value) : value }); (document.activeElement as HTMLElement).blur(); });
for (const key of ["course", "config", "seed", "obstacles"]) scenario(key);
get<HTMLSelectElement>("method").onchange = () => { send({ do: "method", method: get<HTMLSelectElement>("method").value }); get("method").blur(); };
get<HTMLSelectElement>("ghost").onchange = () => { send({ do: "ghost", method: get<HTMLSelectElement>("ghost").value }); get("ghost").blur(); };
get<HTMLSelectElement>("rate").onchange = () => send({ do: "rate", rate: Number(get<HTMLSelectElement>("rate").value) });
const play = () => send({ do: state?.paused ? "play" : "pause" });
click("play", play);
click("step", () => send({ do: "step" }));
click("restart", () => send({ do: "restart" }));
click("real-time", () => send({ do: "real_time", on: !state?.real_time }));
click("fork", () => { const other = hello?.methods.find((m) => m !== state?.method); const to = state?.ghost || other; if (to) send({ do: "fork", method: to }); });
click("theme", () => { setTheme(themeName === "dark" ? "light" : "dark"); localStorage.setItem("slalom-theme", themeName); });
click("help", () => get<HTMLDialogElement>("help-box").showModal());
click("picture", () => { scene.draw(); const a = document.createElement("a"); a.download = `slalom-${state?.course}-${state?.tick}.png`; a.href = get<HTMLCanvasElement>("scene").toDataURL("image/png"); a.click(); });
click("nudge-left", () => send({ do: "nudge", left: 0.15 }));
click("nudge-right", () => send({ do: "nudge", left: -0.15 }));
const timeline = get<HTMLInputElement>("timeline");
timeline.oninput = () => { scrubbing = true; send({ do: "seek", tick: Number(timeline.value) }); };
timeline.onchange = () => (scrubbing = false);
for (const b of document.querySelectorAll<HTMLElement>("[data-tool]")) b.onclick = () => setTool(b.dataset.tool as Tool);
for (const b of document.querySelectorAll<HTMLElement>("[data-follow]")) b.onclick = () => setFollow(b.dataset.follow as "follow");
for (const b of document.querySelectorAll<HTMLElement>("nav button")) b.onclick = () => showPane(b.dataset.pane!);
for (const box of document.querySelectorAll<HTMLInputElement>("[data-layer]"))
  box.onchange = () => { const name = box.dataset.layer as Layer; if (box.checked) scene.visible.add(name); else scene.visible.delete(name); dirty = true; };
get<HTMLSelectElement>("term").onchange = () => { scene.term = get<HTMLSelectElement>("term").value as Term; dirty = true; };

function showPane(name: string) {
  for (const b of document.querySelectorAll<HTMLElement>("nav button")) b.classList.toggle("on", b.dataset.pane === name);
  for (const p of document.querySelectorAll<HTMLElement>(".pane")) p.hidden = p.id !== "pane-" + name;
  if (name === "charts") charts.rebuild();
}

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
  t: () => get("theme").click(),
  l: () => { get<HTMLDetailsElement>("layers").open = !get<HTMLDetailsElement>("layers").open; },
  "?": () => get<HTMLDialogElement>("help-box").showModal(),
  Delete: () => { if (scene.selected > 0) send({ do: "remove", body: scene.selected }); scene.selected = -1; },
  Backspace: () => keys.Delete(),
};
addEventListener("keydown", (event) => {
  const target = event.target as HTMLElement;
  if (/^(INPUT|SELECT|TEXTAREA)$/.test(target.tagName) && !(target instanceof HTMLInputElement && /range|checkbox/.test(target.type))) return;
  if ((event.ctrlKey || event.metaKey) && (event.key === "z" || event.key === "y")) { send({ do: event.key === "z" ? "undo" : "redo" }); event.preventDefault(); return; }
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const act = keys[event.key];
  if (act) { act(); event.preventDefault(); if (event.key === " ") target.blur(); }
});

help(get("help-box"));
get<HTMLSelectElement>("term").append(...terms.map((t) => new Option(t === "total" ? "total cost" : t + " cost", t, t === "total", t === "total")));
if (innerWidth < 900) get<HTMLDetailsElement>("layers").open = false;
if (innerWidth < 900) scene.camera.zoom = 42;
setTheme(themeName);
setTool("disc");
showPane("charts");
requestAnimationFrame(draw);

// What the page knows, for tests and the curious.
Object.assign(window, { slalom: { get frame() { return frame; }, get state() { return state; }, get hello() { return hello; }, get received() { return connection.received; }, scalar, scene, send } });
