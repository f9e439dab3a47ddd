// Drives the page in a real Chromium: node test/browser.mjs PROGRAM [SCREENSHOT_FOLDER]
import { spawn } from "node:child_process";
import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { chromium } from "playwright-core";

const program = process.argv[2], pictures = process.argv[3];
const browserPath = process.env.SLALOM_CHROMIUM ?? ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
if (!program || !browserPath) {
  console.error(program ? "skipped: no Chromium found (apt-get install chromium, or set SLALOM_CHROMIUM)" : "usage: browser.mjs PROGRAM [SCREENSHOT_FOLDER]");
  process.exit(program ? 77 : 2);
}

/** Starts `slalom view` and waits for its address. */
async function serve(...args) {
  const child = spawn(program, ["view", "--course", "stag", "--obstacles", "4", "--seed", "3", ...args], { stdio: ["ignore", "pipe", "inherit"] });
  const address = await new Promise((resolve, reject) => {
    let said = "";
    child.stdout.on("data", (data) => { said += data; const found = said.match(/http:\S+/); if (found) resolve(found[0]); });
    child.on("exit", () => reject(new Error("slalom view ended: " + said)));
  });
  return { child, address, port: new URL(address).port, stop: () => new Promise((done) => { child.removeAllListeners("exit"); child.on("exit", done); child.kill("SIGTERM"); }) };
}

const browser = await chromium.launch({
  executablePath: browserPath,
  args: ["--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
});
let server = await serve("--port", "0");
const problems = [];
const page = await browser.newPage({ viewport: { width: 1440, height: 900 }, colorScheme: "dark" });
page.on("console", (m) => m.type() === "error" && problems.push(m.text()));
page.on("pageerror", (e) => problems.push(e.message));

const scalar = (name) => page.evaluate((n) => slalom.scalar(n), name);
const state = () => page.evaluate(() => slalom.state);
const send = (command) => page.evaluate((c) => slalom.send(c), command);
const until = (what, arg) => page.waitForFunction(what, arg, { timeout: 20000 });
const picture = async (name) => { if (pictures) await page.screenshot({ path: `${pictures}/${name}.png` }); };
/** The scene as it is drawn. */
const sceneBytes = () => page.evaluate(() => { slalom.scene.draw(); return document.getElementById("scene").toDataURL("image/png"); });

let failed = 0;
async function test(name, body) {
  try {
    await body();
    console.log("ok    " + name);
  } catch (error) {
    failed += 1;
    console.log("FAIL  " + name + "\n      " + (error.stack ?? error).split("\n").join("\n      "));
    await picture("failed-" + failed);
  }
}

await test("shows a moving labelled car", async () => {
  const begin = Date.now();
  await page.goto(server.address);
  await until(() => window.slalom?.frame && slalom.scalar("speed") > 0.1 && document.getElementById("label").textContent.includes("svg_mppi"));
  console.log(`      it moved ${Date.now() - begin} ms after opening`);
  const first = await scalar("x");
  await until((x) => Math.abs(slalom.scalar("x") - x) > 0.2, first);
});

await test("pauses, steps one tick, goes back and on", async () => {
  await until(() => slalom.scalar("tick") > 60);
  await page.click("#play");
  await until(() => slalom.state.paused && slalom.state.tick === slalom.scalar("tick"));
  const tick = await scalar("tick");
  await page.click("#step");
  await until((t) => slalom.scalar("tick") === t + 1, tick);
  const there = await scalar("x");
  await page.evaluate(() => { const t = document.getElementById("timeline"); t.value = String(slalom.scalar("tick") - 30); t.dispatchEvent(new Event("input")); t.dispatchEvent(new Event("change")); });
  await until((t) => slalom.scalar("tick") === t - 29, tick);
  assert.match(await page.textContent("#mode-text"), /in the past/);
  await send({ do: "step", ticks: 30 });
  await until((t) => slalom.scalar("tick") === t + 1, tick);
  assert.equal(await scalar("x"), there, "going back and on again ends at the same place, bit for bit");
});

await test("an obstacle dropped in the car's way changes the plan, in the data and in pixels", async () => {
  const before = await page.evaluate(() => ({ plan: slalom.frame.plan.map((p) => [p.x, p.y]), collided: slalom.scalar("collided_share"), bodies: slalom.frame.bodies.length }));
  const pixels = await sceneBytes();
  const [x, y] = await page.evaluate(() => { const c = slalom.scene.camera, p = slalom.frame.plan.at(-1); return c.toScreen(p.x, p.y); });
  const box = await page.locator("#scene").boundingBox();
  await page.mouse.click(box.x + x, box.y + y);
  await until((n) => slalom.frame.bodies.length === n + 1, before.bodies);
  await send({ do: "step", ticks: 2 });
  await until((c) => slalom.scalar("collided_share") > c, before.collided);
  const after = await page.evaluate(() => slalom.frame.plan.map((p) => [p.x, p.y]));
  assert.notDeepEqual(after, before.plan);
  assert.notEqual(await sceneBytes(), pixels);
  await picture("avoidance");
});

await test("an obstacle can be dragged and taken away", async () => {
  const body = await page.evaluate(() => slalom.frame.bodies.at(-1));
  const box = await page.locator("#scene").boundingBox();
  const [x, y] = await page.evaluate((b) => slalom.scene.camera.toScreen(b.x, b.y), body);
  await page.mouse.move(box.x + x, box.y + y);
  await page.mouse.down();
  await page.mouse.move(box.x + x + 40, box.y + y + 10, { steps: 6 });
  await page.mouse.up();
  await until((b) => { const now = slalom.frame.bodies.find((o) => o.id === b.id); return Math.hypot(now.x - b.x, now.y - b.y) > 0.2; }, body);
  const [nx, ny] = await page.evaluate((id) => { const b = slalom.frame.bodies.find((o) => o.id === id); return slalom.scene.camera.toScreen(b.x, b.y); }, body.id);
  await page.mouse.click(box.x + nx, box.y + ny, { button: "right" });
  await until((id) => !slalom.frame.bodies.some((o) => o.id === id), body.id);
});

await test("switches to mppi and back", async () => {
  await page.click("#play");
  await page.selectOption("#method", "mppi");
  await until(() => slalom.hello.methods[slalom.scalar("method")] === "mppi" && slalom.state.method === "mppi");
  assert.equal(await page.evaluate(() => slalom.frame.guides), undefined);
  await page.selectOption("#method", "svg_mppi");
  await until(() => slalom.hello.methods[slalom.scalar("method")] === "svg_mppi" && slalom.frame.guides);
});

await test("a slider changes the option in the solver, and undo takes it back", async () => {
  const before = await scalar("samples");
  await page.click('nav button[data-pane="options"]');
  await page.evaluate(() => { const s = document.querySelector('[data-key="svg_mppi.samples"] input[type=range]'); s.value = "0.4"; s.dispatchEvent(new Event("input")); s.dispatchEvent(new Event("change")); });
  await until((n) => slalom.scalar("samples") !== n && slalom.scalar("samples") > 0, before);
  assert.match(await page.textContent("#command"), /--set 'svg_mppi\.samples=\d+'/);
  await picture("options");
  await page.click("#undo");
  await until((n) => slalom.scalar("samples") === n, before);
  await page.click('nav button[data-pane="charts"]');
});

await test("a value out of range is refused with the rule", async () => {
  await send({ do: "set", key: "svg_mppi.samples", value: "0" });
  await until(() => /must be in/.test(document.getElementById("toast").textContent));
});

await test("forks from the past with the other method and keeps this one as a ghost", async () => {
  await page.click("#play");
  await until(() => slalom.state.paused);
  await send({ do: "seek", tick: (await state()).newest - 20 });
  await until(() => slalom.state.tick === slalom.state.newest - 20);
  await page.click("#fork");
  await until(() => slalom.state.ghost === "svg_mppi" && slalom.state.method === "mppi");
  await page.click("#play");
  await until(() => slalom.frame.ghost && Math.hypot(slalom.frame.ghost.x - slalom.scalar("x"), slalom.frame.ghost.y - slalom.scalar("y")) > 0.02);
  await page.waitForTimeout(1500);
  await picture("ghost");
  await page.selectOption("#ghost", "");
  await until(() => !slalom.frame.ghost);
});

await test("the page of another origin cannot connect", async () => {
  const other = await browser.newPage();
  await other.goto("data:text/html,<p>elsewhere</p>");
  const outcome = await other.evaluate((port) => new Promise((done) => { const s = new WebSocket(`ws://127.0.0.1:${port}/ws`); s.onopen = () => done("open"); s.onerror = () => done("refused"); }), server.port);
  assert.equal(outcome, "refused");
  await other.close();
});

await test("looks right in light colours and on a phone", async () => {
  await page.click("#theme");
  await page.waitForTimeout(300);
  await picture("light");
  await page.setViewportSize({ width: 400, height: 800 });
  await page.waitForTimeout(500);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "nothing reaches beyond 400 pixels");
  await picture("phone-light");
  await page.click("#theme");
  await page.waitForTimeout(300);
  await picture("phone");
  await page.setViewportSize({ width: 2560, height: 1300 });
  await page.waitForTimeout(500);
  await picture("wide");
  await page.setViewportSize({ width: 1440, height: 900 });
});

await test("loads without errors in the console", async () => assert.deepEqual(problems, []));

await test("says that the connection is lost, and reconnects to a new server", async () => {
  await server.stop();
  await until(() => !document.getElementById("lost").hidden);
  server = await serve("--port", server.port);
  await until(() => document.getElementById("lost").hidden && slalom.scalar("tick") < 400 && slalom.scalar("tick") > 3);
});

await browser.close();
await server.stop();
console.log(failed ? `${failed} failed` : "all passed");
process.exit(failed ? 1 : 0);
