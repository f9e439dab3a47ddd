// Draws a series of pictures of an overtake, from the page, as one PNG: node test/overtake.mjs PROGRAM FILE.png [ARGUMENTS OF slalom view]
import { writeFileSync } from "node:fs";
import { launchChromium, startProgram } from "./harness.mjs";

const [program, file, ...given] = process.argv.slice(2);
const scenario = given.length ? given : ["--course", "fox", "--obstacles", "0", "--seed", "1", "--opponents", "1", "--set", "world.opponent_driver=racing",
  "--set", "world.opponent_speed=0.6", "--set", "world.opponent_gap=5", "--set", "world.tracking=exact"];
const size = { width: 460, height: 300 }, columns = 3, rows = 2, most = 4000; // pixels, pictures, control steps

const server = await startProgram(program, ["view", ...scenario, "--port", "0"]);
const browser = await launchChromium();
const page = await browser.newPage({ viewport: { width: 1000, height: 700 }, colorScheme: "light" });
page.setDefaultTimeout(120_000);
await page.goto(server.address);
await page.waitForFunction(() => window.slalom?.frame);
await page.evaluate(() => slalom.send({ do: "pause" }));
await page.waitForFunction(() => slalom.state.paused);
const generation = await page.evaluate(() => slalom.state.generation);
await page.evaluate(() => slalom.send({ do: "restart" }));
await page.waitForFunction((g) => slalom.state.generation > g, generation);
await page.evaluate(() => slalom.scene.visible.clear()); // what is slow to draw and not looked at

/** Where the opponent that is nearest to the car is, in the frame of the car (m), and the time (s). */
const nearest = () => page.evaluate(() => {
  const [car, ...others] = [0, 4].flatMap((kind) => slalom.frame.bodies.filter((body) => body.kind === kind));
  const seen = others.map((b) => ({ ahead: Math.cos(car.yaw) * (b.x - car.x) + Math.sin(car.yaw) * (b.y - car.y), apart: Math.hypot(b.x - car.x, b.y - car.y) }));
  return { tick: slalom.scalar("tick"), time: slalom.scalar("time"), ...seen.sort((a, b) => a.apart - b.apart)[0] };
});
async function step(ticks) {
  const tick = await page.evaluate(() => slalom.scalar("tick"));
  await page.evaluate((t) => slalom.send({ do: "step", ticks: t }), ticks);
  await page.waitForFunction((t) => slalom.scalar("tick") >= t, tick + ticks);
}

// The overtake is over when the opponent that was ahead is 1.5 m behind.
let last = await nearest(), behind = false;
for (let k = 0; k < most / 20 && !(behind && last.apart < 2.5 && last.ahead < -1.5); ++k) {
  await step(20);
  last = await nearest();
  if (last.apart < 3 && last.ahead > 0.5) behind = true;
}
console.log(`over at tick ${last.tick}, ${last.time.toFixed(2)} s`);
if (!behind || last.ahead > -1.5) throw new Error("nobody was overtaken");

// The pictures: back in time, at equal intervals. The car drives to the right.
const count = columns * rows, every = 22; // control steps
const ticks = Array.from({ length: count }, (_, i) => last.tick - (count - 1 - i) * every);
await page.addStyleTag({ content: ".card, .tag, header, footer, #readout, #layers { visibility: hidden !important }" });
const shots = [];
for (const tick of ticks) {
  await page.evaluate((t) => slalom.send({ do: "seek", tick: t }), tick);
  await page.waitForFunction((t) => slalom.scalar("tick") === t, tick);
  const clip = await page.evaluate(({ width, height }) => {
    const { camera, visible } = slalom.scene;
    for (const layer of ["path", "driven", "candidates", "plan", "obstacles", "opponents"]) visible.add(layer);
    const car = slalom.frame.bodies.find((body) => body.kind === 0);
    Object.assign(camera, { follow: "free", turn: -car.yaw, zoom: 80, x: car.x + 1.2 * Math.cos(car.yaw), y: car.y + 1.2 * Math.sin(car.yaw) });
    const canvas = document.querySelector("#scene"), stage = canvas.getBoundingClientRect();
    canvas.dispatchEvent(new PointerEvent("pointerleave")); // draws the scene again
    return { x: stage.left + camera.middleX - width / 2, y: stage.top + camera.middleY - height / 2, width, height };
  }, size);
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  const time = await page.evaluate(() => slalom.scalar("time"));
  shots.push({ words: `${time.toFixed(1)} s`, data: (await page.screenshot({ clip })).toString("base64") });
}
const url = await page.evaluate(async ({ shots, size, columns, rows }) => {
  const gap = 6, canvas = document.createElement("canvas"), pen = canvas.getContext("2d");
  canvas.width = columns * size.width + (columns - 1) * gap;
  canvas.height = rows * size.height + (rows - 1) * gap;
  pen.fillStyle = "white";
  pen.fillRect(0, 0, canvas.width, canvas.height);
  for (const [i, shot] of shots.entries()) {
    const image = new Image();
    image.src = "data:image/png;base64," + shot.data;
    await image.decode();
    const x = (i % columns) * (size.width + gap), y = Math.floor(i / columns) * (size.height + gap);
    pen.drawImage(image, x, y);
    pen.fillStyle = "#222";
    pen.font = "bold 18px sans-serif";
    pen.fillText(shot.words, x + 12, y + 26);
  }
  return canvas.toDataURL("image/png");
}, { shots, size, columns, rows });
writeFileSync(file, Buffer.from(url.split(",")[1], "base64"));
console.log(file);
await browser.close();
await server.stop();
