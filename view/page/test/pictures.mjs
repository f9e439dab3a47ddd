// Draws a picture for the documentation: node test/pictures.mjs PROGRAM introduction|overtake FILE.png
import { writeFileSync } from "node:fs";
import { launchChromium, startProgram } from "./harness.mjs";

const [program, name, file] = process.argv.slice(2);
const world = { opponent_driver: "racing", opponent_speed: 0.6, opponent_gap: 5, tracking: "exact" };
const settings = Object.entries(world).flatMap(([key, value]) => ["--set", `world.${key}=${value}`]);
const overtake = ["--course", "fox", "--obstacles", "0", "--seed", "1", "--opponents", "1", ...settings];
const scenario = { introduction: [], overtake }[name];
if (!scenario || !file) throw new Error("usage: pictures.mjs PROGRAM introduction|overtake FILE.png");

const server = await startProgram(program, ["view", ...scenario, "--port", "0"]);
const browser = await launchChromium();
const size = name === "introduction" ? { width: 1440, height: 900 } : { width: 1000, height: 700 };
const page = await browser.newPage({
  viewport: size,
  colorScheme: name === "introduction" ? "dark" : "light",
});
page.setDefaultTimeout(120_000);
await page.goto(server.address);
await page.waitForFunction(() => window.slalom?.frame);
await page.evaluate(() => slalom.send({ do: "pause" }));
await page.waitForFunction(() => slalom.state.paused);
const generation = await page.evaluate(() => slalom.state.generation);
await page.evaluate(() => slalom.send({ do: "restart" }));
await page.evaluate(() => slalom.send({ do: "pause" }));
await page.waitForFunction((g) => slalom.state.generation > g && slalom.state.paused, generation);

async function step(ticks) {
  const tick = await page.evaluate(() => slalom.state.newest);
  await page.evaluate((t) => slalom.send({ do: "step", ticks: t }), ticks);
  await page.waitForFunction((t) => slalom.scalar("tick") >= t, tick + ticks);
}

/** The introduction when mppi averages and svg_mppi commits. */
async function drawIntroduction() {
  const says = (id, what) =>
    page.evaluate(([i, w]) => document.getElementById(i).dataset.verdict === w, [id, what]);
  do await step(1);
  while (!((await says("ghost-modes", "averages")) && (await says("modes", "commits"))));
  return page.screenshot();
}

/** The opponent that is nearest to the car, in the frame of the car (m). */
const nearest = () =>
  page.evaluate(() => {
    const [car, ...others] = [0, 4].flatMap((kind) =>
      slalom.frame.bodies.filter((body) => body.kind === kind),
    );
    const seen = others.map((b) => ({
      ahead: Math.cos(car.yaw) * (b.x - car.x) + Math.sin(car.yaw) * (b.y - car.y),
      apart: Math.hypot(b.x - car.x, b.y - car.y),
    }));
    return seen.sort((a, b) => a.apart - b.apart)[0];
  });

/** Six pictures of an overtake at equal intervals, in which the car drives to the right. */
async function drawOvertake() {
  const tile = { width: 460, height: 300 };
  const every = 22; // control steps
  await page.evaluate(() => slalom.scene.visible.clear()); // faster, while nobody looks
  // The overtake is over when the opponent that was ahead is 1.5 m behind.
  let wasAhead = false;
  for (let last = {}; !(wasAhead && last.apart < 2.5 && last.ahead < -1.5); last = await nearest()) {
    await step(20);
    wasAhead ||= last.apart < 3 && last.ahead > 0.5;
  }
  await page.addStyleTag({ content: ".card, .tag, header { visibility: hidden !important }" });
  const last = await page.evaluate(() => slalom.state.newest);
  const shots = [];
  for (let tick = last - 5 * every; tick <= last; tick += every) {
    await page.evaluate((t) => slalom.send({ do: "seek", tick: t }), tick);
    await page.waitForFunction((t) => slalom.scalar("tick") === t, tick);
    const clip = await page.evaluate(({ width, height }) => {
      const { camera, visible, draw } = slalom.scene;
      for (const layer of ["path", "driven", "candidates", "plan", "obstacles", "opponents"])
        visible.add(layer);
      const { x, y, yaw } = slalom.frame.bodies[0];
      const place = { x: x + 1.2 * Math.cos(yaw), y: y + 1.2 * Math.sin(yaw) };
      Object.assign(camera, { follow: "free", turn: -yaw, zoom: 80, ...place });
      draw.call(slalom.scene);
      const stage = document.querySelector("#scene").getBoundingClientRect();
      const [left, top] = [stage.left + camera.middleX - width / 2, stage.top + camera.middleY - height / 2];
      return { x: left, y: top, width, height };
    }, tile);
    const words = `${(await page.evaluate(() => slalom.scalar("time"))).toFixed(1)} s`;
    shots.push({ words, data: (await page.screenshot({ clip })).toString("base64") });
  }
  const url = await page.evaluate(tiled, { shots, tile });
  return Buffer.from(url.split(",")[1], "base64");
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

writeFileSync(file, await (name === "introduction" ? drawIntroduction() : drawOvertake()));
await browser.close();
await server.stop();
