import { all, counted, get, make } from "../dom";
import { period, scalar } from "../page";
import { titleParts } from "../scenario";
import { theme } from "../theme";
import type { Camera } from "./camera";
import { costRange } from "./candidates";
import { hasData, layers, term, visible, type Layer } from "./layers";
import { ruler } from "./overlay";
import { Painter, type Pen } from "./painter";
import { css, rampColour } from "./palette";
import { drawScene } from "./scene";
import { camera, ghostCamera, isSideBySide, size } from "./stage";

const margin = 14; // pixels, as all lengths here
const line = 22;
const rampWidth = 120;
const fonts = { plain: "13px sans-serif", bold: "bold 13px sans-serif" };

/** Something in the band below the scene. */
interface Item {
  width: number;
  draw(pen: Pen, x: number, y: number): void;
}

const measure = document.createElement("canvas").getContext("2d")!;
const themed = (name: string) => getComputedStyle(document.documentElement).getPropertyValue(name);

function words(text: string, font = fonts.plain): Item {
  measure.font = font;
  const draw = (pen: Pen, x: number, y: number) => {
    Object.assign(pen, { font, fillStyle: themed("--text") });
    pen.fillText(text, x, y);
  };
  return { width: measure.measureText(text).width, draw };
}

function swatch(colour: string, text: string): Item {
  const name = words(text);
  const draw = (pen: Pen, x: number, y: number) => {
    pen.fillStyle = colour;
    pen.fillRect(x, y - 8, 16, 6);
    name.draw(pen, x + 22, y);
  };
  return { width: 22 + name.width, draw };
}

/** The scale of the candidates' colours, between the costs at its ends. */
function ramp(): Item {
  if (term === "density") return words("Candidates, opaque where they are many");
  const [low, high] = costRange.map((cost) => words(cost.toPrecision(3)));
  const name = words(`Candidates, by ${term} cost`);
  const draw = (pen: Pen, x: number, y: number) => {
    low.draw(pen, x, y);
    const from = x + low.width + 6;
    for (let i = 0; i < rampWidth; i += 3) {
      pen.fillStyle = css(rampColour(theme, i / rampWidth, 1));
      pen.fillRect(from + i, y - 9, 3, 8);
    }
    high.draw(pen, from + rampWidth + 6, y);
    name.draw(pen, from + rampWidth + high.width + 14, y);
  };
  return { width: low.width + high.width + name.width + rampWidth + 20, draw };
}

function scaleBar({ zoom }: Camera): Item {
  const [metres, text] = ruler(zoom);
  const name = words(text);
  const draw = (pen: Pen, x: number, y: number) => {
    pen.fillStyle = themed("--text");
    pen.fillRect(x, y - 5, metres * zoom, 2);
    for (const end of [x, x + metres * zoom - 2]) pen.fillRect(end, y - 9, 2, 8);
    name.draw(pen, x + metres * zoom + 6, y);
  };
  return { width: metres * zoom + 6 + name.width, draw };
}

/** The places of items in rows as wide as the picture, below `from`; the last is the end of the rows. */
function flowed(items: Item[], gap: number, from: number, width: number) {
  const places: { item: Item; x: number; y: number }[] = [];
  let [x, y] = [margin, from + line];
  for (const item of items) {
    if (x > margin && x + item.width > width - margin) [x, y] = [margin, y + line];
    places.push({ item, x, y });
    x += item.width + gap;
  }
  return { places, end: items.length ? y : from };
}

/** The layers that show something, with their colours. */
function key(): Item[] {
  const isShown = (name: Layer) =>
    visible.has(name) && hasData(name) && name !== "modes" && !(name === "ghost" && isSideBySide());
  return layers
    .filter(([name]) => isShown(name))
    .flatMap(([name, title, , colour]) =>
      name === "candidates"
        ? [ramp(), swatch(css(theme.collided), "Candidates that collide")]
        : colour
          ? swatch(css(theme[colour]), title)
          : [],
    );
}

/** The name of a lane, at its top. */
function drawLaneTitle(pen: Pen, text: string, { left, top, middleX }: Camera) {
  const title = words(text, fonts.bold);
  pen.fillStyle = themed("--panel");
  pen.fillRect(middleX - title.width / 2 - 8, top + 8, title.width + 16, line);
  title.draw(pen, middleX - title.width / 2, top + 24);
  pen.fillStyle = themed("--faint");
  if (left) pen.fillRect(left, 0, 1, 1e4);
}

/** Draws the scene with its names, captions, scale and the meaning of its colours below, as a PNG of twice the size. */
export async function picture(): Promise<Blob> {
  const { width, height } = size;
  const time = `${(scalar("tick") * period()).toFixed(2)} s`;
  const title = [...titleParts(), time, counted(scalar("contacts"), "collision")];
  const captions = [...all(".caption:not([hidden])")].map((each) => each.textContent!.trim());
  const spoken = captions.map((text) => text.split(/\s+/).map((word) => words(word)));
  let end = height;
  const rows = [
    { items: title.map((part) => words(part, fonts.bold)), gap: 16 },
    ...spoken.map((items) => ({ items, gap: 4 })),
    { items: [scaleBar(camera), ...key()], gap: 16 },
  ].map(({ items, gap }) => {
    const row = flowed(items, gap, end, width);
    end = row.end;
    return row.places;
  });
  end += margin;

  const ratio = 2;
  const canvas = make("canvas", { width: ratio * width, height: ratio * end });
  const pen = canvas.getContext("2d")!;
  drawScene(new Painter(pen, ratio));
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  if (isSideBySide())
    [camera, ghostCamera].forEach((each, i) =>
      drawLaneTitle(pen, get(i ? "ghost-lane-title" : "lane-title").textContent!, each),
    );
  pen.fillStyle = themed("--panel");
  pen.fillRect(0, height, width, end - height);
  for (const { item, x, y } of rows.flat()) item.draw(pen, x, y);
  return new Promise((done) => canvas.toBlob((blob) => done(blob!), "image/png"));
}
