import { layers } from "./scene/layers";

const mark = `<svg viewBox="0 0 32 32" aria-hidden="true"><path d="M4 24c8 0 8-16 14-16s4 12 10 12" fill="none" stroke="var(--accent)" stroke-width="3.6" stroke-linecap="round"/><circle cx="15" cy="19" r="3.2" fill="#e2663a"/></svg>`;

/** Icons of 16 x 16 for buttons whose text does not fit on narrow screens. */
const icons = {
  play: "M4 2.5v11l9-5.5z", pause: "M4 3h3v10H4zM9 3h3v10H9z", step: "M3 3l7 5-7 5zM11 3h2v10h-2z",
  fork: "M4 14V9l4-3V2h2v4.8L6 9.8V14zM10.400 9l2.600 2v3h-2v-2l-1.800-1.400z", restart: "M8 2a6 6 0 1 0 6 6h-2a4 4 0 1 1-4-4v3l5-4-5-4z",
};
export const icon = (name: keyof typeof icons) => `<svg class="icon" viewBox="0 0 16 16" aria-hidden="true"><path fill="currentColor" d="${icons[name]}"/></svg>`;

const speeds: [number, string][] = [[0.1, "0.1×"], [0.25, "0.25×"], [0.5, "0.5×"], [1, "1×"], [2, "2×"], [4, "4×"], [0, "Max speed"]];
const panes = ["charts", "options", "laps", "evaluation"];
const titled = (text: string) => text[0].toUpperCase() + text.slice(1);

export function layout(root: HTMLElement) {
  root.innerHTML = `
<header>
  <div class="brand">${mark}<h1>Slalom</h1></div>
  <div id="primary">
    <label class="field"><span>Course</span><select id="course"></select></label>
    <label class="field"><span>Method</span><select id="method"></select></label>
    <label class="field" title="A second method that drives on the same seed"><span>Ghost</span><select id="ghost"></select></label>
  </div>
  <div class="menu" id="scenario-menu">
    <button id="scenario-open">Scenario</button>
    <div class="card sheet" id="scenario" role="group" aria-label="Scenario"><div id="primary-folded"></div>
      <label class="field"><span>Configuration</span><select id="config"></select></label>
      <label class="field"><span>Obstacles</span><input id="obstacles" type="number" min="0" max="60" title="Number of parked cars"></label>
      <label class="field"><span>Opponents</span><input id="opponents" type="number" min="0" max="16" title="Number of cars that drive along the line"></label>
      <label class="field"><span>Seed</span><input id="seed" type="number" min="0"></label>
      <label class="field check" title="Commands take effect after the time that the planner needed"><span>Real time</span><input id="real-time" type="checkbox"></label>
    </div>
  </div>
  <span id="caption" hidden></span>
  <div class="grow"></div>
  <span class="pill" id="mode"><i></i><span id="mode-text">…</span></span>
  <span class="pill" id="connection" role="status"><i></i><span id="connection-text">connecting</span></span>
  <div class="menu"><button id="save-open" title="Save or share (S)" aria-label="Save or share">Save<span class="long"> or share</span></button><div class="card" id="save" role="group" aria-label="Save or share">
    <button id="save-picture">Picture<small>of the scene, PNG</small></button>
    <button id="save-replay">Replay<small>a page that opens from disk</small></button>
    <button id="save-recording">Recording<small>MCAP, for Foxglove and Lichtblick</small></button>
    <button id="save-link">Link<small>the address of this scenario</small></button>
  </div></div>
  <button id="theme" class="square" title="Dark or light (T)" aria-label="Dark or light colours">◐</button>
  <button id="help" class="square" title="Keys and gestures (?)" aria-label="Keys and gestures">?</button>
</header>
<main id="stage" aria-label="Scene">
  <canvas id="scene" tabindex="0" role="img" aria-label="The course, the car and the plans of the controller from above"></canvas>
  <div id="label" class="tag" hidden></div>
  <div id="ghost-label" class="tag" hidden></div>
  <details id="layers" class="card" open><summary>Layers</summary>
    ${layers.map(([name, title, text]) => `<label title="${text}"><input type="checkbox" data-layer="${name}" checked>${title}<span class="swatch" data-swatch="${name}"></span></label>`).join("")}
    <div class="scale"><select id="term" aria-label="Cost that colours the candidates"></select><div id="ramp"></div><p class="numbers"><span id="scale-low">0</span><span id="scale-high">1</span></p><p id="scale-text">low to high cost; line width = weight</p></div>
  </details>
  <div id="readout" class="card numbers">
    <span>speed</span><b id="speed">–<small>m/s</small></b>
    <span id="lap-number">lap 1</span><b id="lap-time">–<small>s</small></b>
    <span class="extra">clearance</span><b class="extra" id="clearance">–<small>m</small></b>
    <span class="extra" id="solve-label">planner</span><b class="extra" id="solve">–<small>ms</small></b>
    <span>collisions</span><b id="contacts">0</b>
    <span id="best-label" title="Time behind the best lap at this place, without the laps of a ghost" hidden>to best lap</span><b id="best" hidden>–<small>s</small></b>
    <span id="gap-label" hidden>to ghost</span><b id="gap" hidden>–<small>m</small></b>
  </div>
  <canvas id="minimap" class="card" role="img" aria-label="The whole course, with the car and the part that is in view" hidden></canvas>
  <i id="divider" hidden></i>
  <p id="lane-title" class="card lane-title numbers" hidden></p>
  <p id="ghost-lane-title" class="card lane-title numbers" hidden></p>
  <p id="no-picture" class="card" hidden>This browser has no WebGL 2, with which the scene is drawn. Charts, options and laps work without it.</p>
  <p id="modes" class="card caption" hidden></p>
  <p id="ghost-modes" class="card caption" hidden></p>
  <div id="introduction" class="card" role="region" aria-label="Introduction" hidden><p id="introduction-text"></p><button id="introduction-again">Show again</button><button id="introduction-close">Close</button></div>
  <div id="ruler" class="numbers"><span id="ruler-text"></span><div id="ruler-bar"></div></div>
  <div id="restore" class="card" role="alertdialog" aria-labelledby="restore-text" hidden><p id="restore-text">The server was started anew, with another scenario.</p><div class="row end"><button id="restore-not">Keep the server's</button><button id="restore-mine" class="primary">Restore my scenario</button></div></div>
  <div id="lost" role="alertdialog" aria-labelledby="lost-title" hidden><div class="card"><h2 id="lost-title">Connection lost</h2><p id="lost-text"></p></div></div>
</main>
<div id="tools" role="region" aria-label="Edit the world, and the view">
  <span class="group" role="group" aria-label="What a click places">
    <button data-tool="disc" title="A click places a pole (1)">Pole</button><button data-tool="box" title="A click places a box (2)">Box</button>
    <button data-tool="car" title="A click places a parked car (3)">Car</button><button data-tool="pan" title="A click only selects (4)">Select</button>
  </span>
  <span class="group"><button id="nudge-left" title="Push the car to its left ([)">← Nudge</button><button id="nudge-right" title="Push the car to its right (])">Nudge →</button></span>
  <span class="group" role="group" aria-label="What the view follows">
    <button data-follow="follow" title="Follow the car (F)">Follow</button><button data-follow="heading" title="Follow, heading up (F)">Heading up</button><button data-follow="fit" title="Show the whole course (A)">Fit course</button>
    <button id="space" title="The scene in space, or from above (C)">3D</button>
    <button id="split" title="The ghost beside the car (G)" hidden>Side by side</button>
  </span>
</div>
<div id="bar" role="region" aria-label="Time">
  <button id="play" title="Play or pause (Space)"></button>
  <button id="step" title="One control step (.)">${icon("step")}<span>Step</span></button>
  <button id="fork" title="Continue from here with another method or other options (K)">${icon("fork")}<span>Fork…</span></button>
  <select id="rate" aria-label="Speed">${speeds.map(([v, t]) => `<option value="${v}"${v === 1 ? " selected" : ""}>${t}</option>`).join("")}</select>
  <div class="track"><input id="timeline" type="range" min="0" max="1" step="1" aria-label="The last minute"><i id="timeline-mark" hidden></i></div>
  <span class="time numbers" id="time">0.00 s</span>
  <button id="restart" title="Restart from the beginning (R)">${icon("restart")}<span>Restart</span></button>
</div>
<aside aria-label="Details">
  <nav role="tablist" aria-label="Details">${panes.map((name) => `<button role="tab" id="tab-${name}" data-pane="${name}" aria-controls="pane-${name}"${name === "evaluation" ? " hidden" : ""}>${titled(name)}</button>`).join("")}</nav>
  <div class="pane" id="pane-charts"><div id="charts"></div><div class="row end"><button id="csv" title="The values of the charts, as they are shown">Save as CSV</button></div></div>
  <div class="pane" id="pane-options" hidden><div id="options"></div></div>
  <div class="pane" id="pane-laps" hidden><p id="about"></p><div id="laps"></div></div>
  <div class="pane" id="pane-evaluation" hidden><div id="evaluation"></div></div>
</aside>
<div id="toast" class="card" role="status" hidden></div>
<dialog id="help-box" aria-labelledby="help-title"></dialog>
<dialog id="preset-box" aria-labelledby="preset-title"></dialog>
<dialog id="fork-box" aria-labelledby="fork-title"></dialog>`;
  for (const pane of root.querySelectorAll<HTMLElement>(".pane")) {
    pane.setAttribute("role", "tabpanel");
    pane.setAttribute("aria-labelledby", pane.id.replace("pane", "tab"));
    pane.tabIndex = 0;
  }
}

/** Course, method and ghost are in the header where there is room, and in the sheet of the scenario otherwise. */
export function foldHeader() {
  const narrow = matchMedia("(max-width: 1099px)"), primary = document.getElementById("primary")!;
  const fold = () => {
    if (narrow.matches) document.getElementById("primary-folded")!.append(primary);
    else document.getElementById("scenario-menu")!.before(primary);
  };
  narrow.addEventListener("change", fold);
  fold();
}

const keys: [string, string][] = [
  ["Space", "pause and continue"], [".", "one control step forward"], [",", "one control step back"], ["R", "restart from the beginning"], ["F", "follow the car, heading up or not"], ["A", "fit the course"], ["C", "the scene in space, or from above"], ["G", "car and ghost side by side, or in one picture"],
  ["← → ↑ ↓", "move the view; in space, turn it"], ["+ -", "zoom"], ["1 2 3 4", "pole, box, parked car, select"], ["[ ]", "push the car to its left or right"], ["Delete", "delete the selected obstacle"], ["Ctrl Z, Ctrl Y", "undo and redo an option"], ["K", "fork from the control step shown"], ["S", "save or share: picture, replay, recording, link"], ["L", "layers"], ["T", "dark or light"], ["?", "this help"],
];

export function help(box: HTMLElement) {
  box.innerHTML = `<h2 id="help-title">Keys and gestures</h2><dl>${keys.map(([k, t]) => `<dt>${k.split(" ").map((p) => `<kbd>${p}</kbd>`).join(" ")}</dt><dd>${t}</dd>`).join("")}
<dt>Click</dt><dd>place what is chosen below the scene; an obstacle or the car can be dragged</dd><dt>Right click, long press</dt><dd>delete an obstacle</dd><dt>Drag, wheel, pinch</dt><dd>move and zoom; in space, a drag turns the view</dd></dl>
<form method="dialog"><button class="primary">Close</button></form>`;
}
