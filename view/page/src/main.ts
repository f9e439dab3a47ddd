import "./style.css";
import { acknowledge, ask, connect, send, waiting } from "./connection";
import "./keys";
import { draw, isReplay, page, scalar } from "./page";
import "./panes/charts";
import { showPane } from "./panes/tabs";
import { past } from "./past";
import "./readout";
import "./scene/overlay";
import * as layers from "./scene/layers";
import * as scene from "./scene/scene";
import * as stage from "./scene/stage";
import "./status";
import { showTheme } from "./theme";

// Each module has what it knows for itself, and is told the news of the others (page.ts).

showTheme();
showPane("charts");
connect();

function turn() {
  draw();
  acknowledge();
  requestAnimationFrame(turn);
}
requestAnimationFrame(turn);

// For tests, and for debugging in the console: the news, and the modules.
const figures = { scalar, waiting: () => waiting, isReplay };
const modules = { past, layers, scene, stage, send, ask };
Object.assign(window, { slalom: Object.assign(Object.create(page), figures, modules) });
