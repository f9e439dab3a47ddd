// Draws a picture for the pages and prints its figures (script/pictures): node test/pictures.mjs PROGRAM NAME FILE
import { execFileSync } from "node:child_process";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { Harness } from "./harness.mjs";

const [program, name, file] = process.argv.slice(2);
const world = { opponent_driver: "racing", opponent_speed: 0.6, opponent_gap: 5, tracking: "exact" };
const settings = Object.entries(world).flatMap(([key, value]) => ["--set", `world.${key}=${value}`]);
const overtake = ["--course", "fox", "--obstacles", "0", "--seed", "1", "--opponents", "1", ...settings];
const twoWays = "--course stag --config published --obstacles 1 --seed 77 --against mppi --record-all".split(" ");
const scenarios = { "live-view": [], overtake, "two-ways": twoWays };
const scenario = scenarios[name];
if (!scenario || !file)
  throw new Error(`usage: pictures.mjs PROGRAM ${Object.keys(scenarios).join("|")} FILE`);

const h = new Harness(program);
const isIntroduction = name === "live-view";
const viewport = isIntroduction ? { width: 1440, height: 900 } : { width: 1000, height: 700 };
await h.openAll(scenario, { viewport, colorScheme: isIntroduction ? "dark" : "light" });
const { page } = h;
if (!isIntroduction) {
  await h.restart();
  await h.pause();
}

/** The part of the introduction in which mppi averages and svg_mppi commits. */
async function drawIntroduction() {
  for (let part = 1; part <= 4; ++part) {
    await h.says("introduction-text", `${part} of 5. `);
    if (part < 4) await page.keyboard.press("n");
  }
  await h.drawn();
  return page.screenshot();
}

/** The place of the opponent in the frame of the car (m). */
const opponent = () =>
  page.evaluate(() => {
    const { bodies } = slalom.frame;
    const [car, other] = [0, 4].map((kind) => bodies.find((body) => body.kind === kind));
    const [x, y] = [other.x - car.x, other.y - car.y];
    return { ahead: Math.cos(car.yaw) * x + Math.sin(car.yaw) * y, apart: Math.hypot(x, y) };
  });

/** Six pictures of an overtake at equal intervals, in which the car drives to the right. */
async function drawOvertake() {
  const tile = { width: 460, height: 300 };
  const every = 20; // control steps
  await page.evaluate(() => slalom.layers.visible.clear()); // faster, while nobody looks
  // The overtake is over when the opponent that was ahead is 0.9 m behind.
  let wasAhead = false;
  for (let last = {}; !(wasAhead && last.apart < 2.5 && last.ahead < -0.9); last = await opponent()) {
    await h.step(3);
    wasAhead ||= last.apart < 3 && last.ahead > 0.5;
  }
  await page.addStyleTag({ content: ".card, .tag, header { visibility: hidden !important }" });
  const { newest } = await h.state();
  const shots = [];
  for (let tick = newest - 5 * every; tick <= newest; tick += every) {
    await h.seek(tick);
    const clip = await page.evaluate(({ width, height }) => {
      const { camera } = slalom.stage;
      const layers = ["path", "driven", "candidates", "plan", "obstacles", "opponents"];
      for (const layer of layers) slalom.layers.visible.add(layer);
      const { x, y, yaw } = slalom.frame.bodies[0];
      const place = { x: x + 1.2 * Math.cos(yaw), y: y + 1.2 * Math.sin(yaw) };
      Object.assign(camera, { follow: "free", turn: -yaw, zoom: 80, ...place });
      slalom.scene.drawScene();
      const stage = document.querySelector("#scene").getBoundingClientRect();
      const [left, top] = [stage.left + camera.middleX - width / 2, stage.top + camera.middleY - height / 2];
      return { x: left, y: top, width, height };
    }, tile);
    const words = `${(await h.scalar("time")).toFixed(1)} s`;
    console.log(words);
    shots.push({ words, data: (await page.screenshot({ clip })).toString("base64") });
  }
  return Buffer.from((await page.evaluate(tiled, { shots, tile })).split(",")[1], "base64");
}

/** Puts pictures with their words into two rows; runs in the page. */
async function tiled({ shots, tile }) {
  const [gap, columns] = [6, 3];
  const canvas = document.createElement("canvas");
  const pen = canvas.getContext("2d");
  canvas.width = columns * (tile.width + gap) - gap;
  canvas.height = 2 * tile.height + gap;
  pen.fillStyle = "white";
  pen.fillRect(0, 0, canvas.width, canvas.height);
  pen.fillStyle = "#222";
  pen.font = "bold 18px sans-serif";
  for (const [i, shot] of shots.entries()) {
    const image = new Image();
    image.src = "data:image/png;base64," + shot.data;
    await image.decode();
    const [x, y] = [(i % columns) * (tile.width + gap), Math.floor(i / columns) * (tile.height + gap)];
    pen.drawImage(image, x, y);
    pen.fillText(shot.words, x + 12, y + 26);
  }
  return canvas.toDataURL("image/png");
}

/** A video of the two controllers, until they have passed the parked car. */
async function filmTwoWays() {
  const end = 64; // control steps, 1.6 s
  const driven = await h.scalar("tick");
  if (driven < end) await h.step(end - driven);
  await page.click("#save-open");
  const recording = join(h.folder, "two-ways.mcap");
  await (await h.saved("#save-recording")).saveAs(recording);
  const span = ["--from", "0.95", "--to", "1.6", "--speed", "0.2"];
  execFileSync(program, ["export", recording, file, ...span], { stdio: "inherit" });
}

if (name === "two-ways") await filmTwoWays();
else writeFileSync(file, await (isIntroduction ? drawIntroduction() : drawOvertake()));
console.log(await page.innerText("body"));
await h.close();
