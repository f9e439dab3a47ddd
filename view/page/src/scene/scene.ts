import { get, say } from "../dom";
import { drivenOf, on, page } from "../page";
import { ghostPast, past } from "../past";
import type { Frame } from "../protocol";
import { theme } from "../theme";
import type { Camera } from "./camera";
import { costRange, drawCandidates, scaleCosts } from "./candidates";
import * as draw from "./drawings";
import { visible, type Layer } from "./layers";
import { painterOf, type Painter } from "./painter";
import { preview, selected } from "./pointer";
import * as shapes from "./shapes";
import { camera, ghostCamera, isSideBySide, placeCameras, size } from "./stage";

// The scene: all that the controller considers, seen from above.

const canvas = get<HTMLCanvasElement>("scene");
/** Draws on the page, or with the pen of a picture. */
export function drawScene(painter = painterOf(canvas, size)) {
  painter.begin(size.width, size.height, page.scene?.grid ? theme.ground : theme.free);
  placeCameras();
  const { frame } = page;
  if (frame?.candidates) scaleCosts(frame.candidates); // both lanes have one scale
  drawLane(painter, camera, frame, past.line());
  if (isSideBySide()) drawLane(painter, ghostCamera, frame?.ghostFrame, ghostPast.line());
  painter.end();
}

function drawLane(painter: Painter, camera: Camera, frame: Frame | undefined, driven: number[]) {
  const body = drivenOf(frame);
  const end = frame?.plan?.at(-1);
  if (body) camera.track(body.x, body.y, body.yaw, end ? Math.hypot(end.x - body.x, end.y - body.y) : 0);
  painter.look(camera);
  if (page.scene?.grid) draw.drawMap(painter, page.scene.grid);
  if (!frame || !page.hello) return;
  /** Draws a layer if it is to be shown and has data. */
  const show = <Data>(layer: Layer, data: Data | undefined, act: (painter: Painter, data: Data) => void) => {
    if (visible.has(layer) && data !== undefined) act(painter, data);
  };
  show("costMap", frame.costMap, draw.drawCostMap);
  show("path", page.scene?.path, draw.drawPath);
  show("path", frame.lines, draw.drawLines);
  show("driven", driven, () => painter.polyline(driven, 0, driven.length / 2, theme.driven, 2));
  show("candidates", frame.candidates, drawCandidates);
  show("spread", frame.plan, draw.drawSpread);
  show("guides", frame.guides, draw.drawGuides);
  show("scan", frame.scan, draw.drawScan);
  for (const each of frame.bodies) {
    if (each.kind === 4) show("opponents", each, shapes.drawOpponent);
    else if (each.kind !== 0)
      show("obstacles", each, () => shapes.drawObstacle(painter, each, selected === each.id));
  }
  for (const polygon of frame.polygons ?? []) show("obstacles", polygon, shapes.drawPolygon);
  show("opponents", frame.others, shapes.drawTracked);
  if (preview) shapes.drawPreview(painter, preview);
  show("nominal", frame.nominal, (_, { xy, points }) => painter.dashed(xy, points, theme.nominal, 1.6));
  show("plan", frame.plan, draw.drawPlan);
  if (!isSideBySide()) show("ghost", frame.ghostFrame, shapes.drawGhost);
  const probe = page.cursor === undefined ? undefined : past.pose(page.cursor);
  if (probe) shapes.drawOutline(painter, probe, theme.selected);
  shapes.drawDriven(painter, frame, theme.car);
  if (body?.touched) shapes.drawCross(painter, body, 12 / camera.zoom);
}

on("drawn", () => {
  drawScene();
  const [low, high] = costRange;
  say(get("scale-low"), low.toPrecision(3));
  say(get("scale-high"), high.toPrecision(3));
});
