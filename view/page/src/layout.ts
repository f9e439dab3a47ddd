import { layers } from "./scene";

const mark = `<svg viewBox="0 0 32 32" aria-hidden="true"><path d="M4 24c8 0 8-16 14-16s4 12 10 12" fill="none" stroke="var(--accent)" stroke-width="3.6" stroke-linecap="round"/><circle cx="15" cy="19" r="3.2" fill="#e2663a"/></svg>`;

export function layout(root: HTMLElement) {
  root.innerHTML = `
<header>
  <div class="brand">${mark}<b>Slalom</b></div>
  <label class="field"><span>Course</span><select id="course" aria-label="course"></select></label>
  <label class="field"><span>Method</span><select id="method" aria-label="method"></select></label>
  <label class="field"><span>Against</span><select id="ghost" aria-label="second method, driven as a ghost on the same seed"></select></label>
  <label class="field wide"><span>Config</span><select id="config" aria-label="configuration"></select></label>
  <label class="field"><span>Obstacles</span><input id="obstacles" type="number" min="0" max="60" aria-label="parked cars" title="parked cars"></label>
  <label class="field wide"><span>Opponents</span><input id="opponents" type="number" min="0" max="16" aria-label="cars that drive along the line" title="cars that drive along the line"></label>
  <label class="field"><span>Seed</span><input id="seed" type="number" min="0" aria-label="seed" title="seed"></label>
  <span id="caption" hidden></span>
  <div class="grow"></div>
  <span class="pill" id="mode"><i></i><span id="mode-text">…</span></span>
  <span class="pill wide" id="connection"><i></i><span id="connection-text">connecting</span></span>
  <details class="menu" id="save"><summary role="button" title="Save (S)">Save</summary><div class="card">
    <button id="save-picture">Picture<small>of the scene, PNG</small></button>
    <button id="save-replay">Replay<small>a page that opens from disk</small></button>
    <button id="save-recording">Recording<small>MCAP, for Foxglove and Lichtblick</small></button>
    <button id="save-link">Link<small>the address of this scenario</small></button>
  </div></details>
  <button id="theme" title="Dark or light (T)" aria-label="dark or light">◐</button>
  <button id="help" title="Keys and gestures (?)" aria-label="help">?</button>
</header>
<div id="stage">
  <canvas id="scene" tabindex="0" aria-label="the scene from above"></canvas>
  <div id="label" class="tag" hidden></div>
  <div id="ghost-label" class="tag" hidden></div>
  <details id="layers" class="card" open><summary>Layers</summary>
    ${layers.map(([name, title, text]) => `<label title="${text}"><input type="checkbox" data-layer="${name}" checked>${title}<span class="swatch" data-swatch="${name}"></span></label>`).join("")}
    <div class="scale"><select id="term" aria-label="cost term that colours the candidates"></select><div id="ramp"></div><p><span id="scale-low">0</span><span>best to worst</span><span id="scale-high">1</span></p></div>
  </details>
  <div id="readout" class="card numbers">
    <span>speed</span><b id="speed">–<small>m/s</small></b>
    <span id="lap-number">lap 1</span><b id="lap-time">–<small>s</small></b>
    <span class="extra">clearance</span><b class="extra" id="clearance">–<small>m</small></b>
    <span class="extra" id="solve-label">planner</span><b class="extra" id="solve">–<small>ms</small></b>
    <span>collisions</span><b id="contacts">0</b>
    <span id="gap-label" hidden>to ghost</span><b id="gap" hidden>–<small>m</small></b>
  </div>
  <div id="ruler" class="numbers wide"><span id="ruler-text"></span><div id="ruler-bar"></div></div>
  <div id="tools" class="card" role="toolbar" aria-label="edit the world">
    <button data-tool="disc" title="Click to place a pole (1)">Pole</button><button data-tool="box" title="Click to place a box (2)">Box</button>
    <button data-tool="car" title="Click to place a parked car (3)">Car</button><button data-tool="pan" title="Clicks only select (4)">Select</button>
    <span class="gap wide"></span>
    <button id="nudge-left" class="wide" title="Push the car to its left ([)">⇠ Nudge</button><button id="nudge-right" class="wide" title="Push the car to its right (])">Nudge ⇢</button>
    <span class="gap"></span>
    <button data-follow="follow" title="Follow the car (F)">Follow</button><button data-follow="heading" class="wide" title="Follow, heading up (F)">Heading up</button><button data-follow="fit" title="Show all (A)">All</button>
  </div>
  <div id="lost" hidden><div class="card"><h2>Connection lost</h2><p id="lost-text"></p></div></div>
</div>
<div id="bar">
  <button id="play" title="Space">▶ Play</button>
  <button id="step" title="One tick (.)">+1 tick</button>
  <button id="fork" title="Continue from here with another method or other options (K)" hidden>Fork…</button>
  <select id="rate" aria-label="speed of time">${[[0.1, "0.1×"], [0.25, "0.25×"], [0.5, "0.5×"], [1, "1×"], [2, "2×"], [4, "4×"], [0, "max"]].map(([v, t]) => `<option value="${v}"${v === 1 ? " selected" : ""}>${t}</option>`).join("")}</select>
  <input id="timeline" type="range" min="0" max="1" step="1" aria-label="the last minute">
  <span class="time numbers" id="time">0.00 s</span>
  <button id="real-time" class="wide" title="Commands take effect after the time that the planner needed">Real time</button>
  <button id="restart" title="Restart from the beginning (R)">Restart</button>
</div>
<aside>
  <nav><button data-pane="charts">Charts</button><button data-pane="options">Options</button><button data-pane="laps">Laps</button><button data-pane="evaluation" hidden>Evaluation</button></nav>
  <div class="pane" id="pane-charts"><div id="charts"></div></div>
  <div class="pane" id="pane-options" hidden><div id="options"></div></div>
  <div class="pane" id="pane-laps" hidden><p id="about"></p><div id="laps"></div></div>
  <div class="pane" id="pane-evaluation" hidden><div id="evaluation"></div></div>
</aside>
<div id="toast" class="card" role="status" hidden></div>
<dialog id="help-box"></dialog>
<dialog id="fork-box"></dialog>`;
}

const keys: [string, string][] = [
  ["Space", "pause and continue"], [".", "forward by one tick"], [",", "back by one tick"], ["R", "restart from the beginning"], ["F", "follow the car, heading up or not"], ["A", "show the whole course"],
  ["1 2 3 4", "pole, box, parked car, select"], ["[ ]", "push the car to its left or right"], ["Delete", "remove the selected obstacle"], ["Ctrl Z, Ctrl Y", "undo and redo an option"], ["K", "fork from the displayed tick"], ["S", "save: picture, replay, recording"], ["L", "layers"], ["T", "dark or light"], ["?", "this help"],
];

export function help(box: HTMLElement) {
  box.innerHTML = `<h2>Keys and gestures</h2><dl>${keys.map(([k, t]) => `<dt>${k.split(" ").map((p) => `<kbd>${p}</kbd>`).join(" ")}</dt><dd>${t}</dd>`).join("")}
<dt>Click</dt><dd>place what is selected below the scene; an obstacle or the car can be dragged</dd><dt>Right click</dt><dd>remove an obstacle</dd><dt>Drag, wheel, pinch</dt><dd>move and zoom</dd></dl>
<form method="dialog"><button class="primary">Close</button></form>`;
}
