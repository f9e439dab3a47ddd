// Drives the page in a real Chromium: node test/browser.mjs PROGRAM [SCREENSHOT_FOLDER]
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";
import { startProgram } from "./program.mjs";

const program = process.argv[2], pictures = process.argv[3];
const browserPath = process.env.SLALOM_CHROMIUM ?? ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
if (!program || !browserPath) {
  console.error(program ? "skipped: no Chromium found (apt-get install chromium, or set SLALOM_CHROMIUM)" : "usage: browser.mjs PROGRAM [SCREENSHOT_FOLDER]");
  process.exit(program ? 77 : 2);
}

const folder = mkdtempSync(join(tmpdir(), "slalom-view-"));
const start = (...args) => startProgram(program, args);
const serve = (...args) => start("view", "--course", "stag", "--obstacles", "4", "--seed", "3", ...args);

const browser = await chromium.launch({
  executablePath: browserPath,
  args: ["--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
});
let server = await serve("--port", "0");
const problems = [];
/** A page whose errors are collected. */
async function open(address) {
  const opened = await browser.newPage({ viewport: { width: 1440, height: 900 }, colorScheme: "dark" });
  opened.on("console", (m) => m.type() === "error" && problems.push(m.text()));
  opened.on("pageerror", (e) => problems.push(e.message));
  if (address) await opened.goto(address);
  return opened;
}
const page = await open();

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
  await page.selectOption("#fork-method", "mppi");
  await page.click("#fork-go");
  await until(() => slalom.state.ghost === "svg_mppi" && slalom.state.method === "mppi");
  await page.click("#play");
  await until(() => slalom.frame.ghost && Math.hypot(slalom.frame.ghost.x - slalom.scalar("x"), slalom.frame.ghost.y - slalom.scalar("y")) > 0.02);
  await page.waitForTimeout(1500);
  await picture("ghost");
  await page.selectOption("#ghost", "");
  await until(() => !slalom.frame.ghost);
});

await test("forks with other options of the same method", async () => {
  await page.selectOption("#method", "svg_mppi");
  await until(() => slalom.state.method === "svg_mppi" && slalom.scalar("tick") > 25);
  await page.click("#play");
  await until(() => slalom.state.paused);
  await send({ do: "seek", tick: (await state()).newest - 20 });
  await page.keyboard.press("k");
  await page.selectOption("#fork-method", "svg_mppi");
  await page.fill("#fork-options", "samples=640 vehicle.max_steering=0.3");
  await page.click("#fork-go");
  await until(() => /max_steering/.test(document.getElementById("toast").textContent) || slalom.state.ghost === "svg_mppi");
  await page.keyboard.press("k");
  await page.selectOption("#fork-method", "svg_mppi");
  await page.fill("#fork-options", "samples=640");
  await page.click("#fork-go");
  await until(() => slalom.state.ghost_label === "svg_mppi as before");
  await page.click("#play");
  await until(() => slalom.scalar("samples") === 640 && /as before/.test(document.getElementById("ghost-label").textContent));
  await send({ do: "undo" });
  await page.selectOption("#ghost", "");
});

await test("a ghost on the same seed starts beside the car", async () => {
  await page.selectOption("#ghost", "mppi");
  await page.click("#restart");
  await until(() => slalom.frame.ghost && slalom.scalar("tick") > 30 && slalom.scalar("tick") < 400 && Math.hypot(slalom.frame.ghost.x - slalom.scalar("x"), slalom.frame.ghost.y - slalom.scalar("y")) > 0.005);
  assert.ok(Math.abs(await page.evaluate(() => slalom.frame.ghost.laps - slalom.scalar("lap") - slalom.scalar("progress"))) < 0.1);
  await page.selectOption("#ghost", "");
  await until(() => !slalom.frame.ghost);
});

await test("opponents drive along the line", async () => {
  await page.fill("#opponents", "2");
  await page.press("#opponents", "Enter");
  await until(() => slalom.state.opponents === 2 && slalom.frame.bodies.filter((b) => b.kind === 4).length === 2);
  const first = await page.evaluate(() => slalom.frame.bodies.find((b) => b.kind === 4).x);
  await until((x) => Math.abs(slalom.frame.bodies.find((b) => b.kind === 4).x - x) > 0.3, first);
  await send({ do: "scenario", opponents: 0 });
  await until(() => slalom.state.opponents === 0);
});

await test("the address holds the scenario and what was changed", async () => {
  await send({ do: "set", key: "svg_mppi.samples", value: "777" });
  await until(() => location.hash.includes("set=svg_mppi.samples=777"));
  const address = page.url();
  await send({ do: "scenario", course: "eel", seed: "9" });
  await until(() => slalom.state.course === "eel" && location.hash.includes("course=eel") && !location.hash.includes("777"));
  const other = await open(address);
  await other.waitForFunction(() => slalom.state?.course === "stag" && slalom.scalar("samples") === 777, undefined, { timeout: 20000 });
  await other.close();
  await send({ do: "reset_options" });
});

await test("keys are explained", async () => {
  await page.keyboard.press("?");
  await until(() => document.getElementById("help-box").open);
  await picture("help");
  await page.keyboard.press("Escape");
});

/** What the page saves when something is clicked. */
async function saved(from, id) {
  await from.click("#save > summary");
  const [file] = await Promise.all([from.waitForEvent("download", { timeout: 60000 }), from.click(id)]);
  const path = join(folder, file.suggestedFilename());
  await file.saveAs(path);
  return path;
}

await test("saves a picture", async () => {
  const file = await saved(page, "#save-picture");
  assert.equal(readFileSync(file).subarray(1, 4).toString(), "PNG");
  assert.ok(statSync(file).size > 10000);
});

/** A replay that is open: it plays, at the speed that was chosen, and can be scrubbed. */
async function plays(replay) {
  const wait = (what, arg) => replay.waitForFunction(what, arg, { timeout: 20000 });
  await wait(() => window.slalom?.replay && slalom.frame && slalom.state.newest > 40 && document.getElementById("label").textContent.includes("svg_mppi"));
  const first = await replay.evaluate(() => slalom.state.tick);
  await wait((t) => slalom.state.tick > t, first);
  await replay.click("#play");
  await wait(() => slalom.state.paused);
  await replay.evaluate(() => { const t = document.getElementById("timeline"); t.value = "30"; t.dispatchEvent(new Event("input")); t.dispatchEvent(new Event("change")); });
  await wait(() => slalom.state.tick === 30);
  const there = await replay.evaluate(() => slalom.scalar("tick"));
  await replay.click("#step");
  await wait((t) => slalom.scalar("tick") === t + 1, there);
  assert.deepEqual(await replay.evaluate(() => [...document.getElementById("rate").options].map((o) => Number(o.value))), [0.1, 0.25, 0.5, 1, 2, 4]);
  await replay.selectOption("#rate", "4");
  await replay.click("#play");
  await wait(() => slalom.state.tick > 35);
  assert.equal(await replay.evaluate(() => getComputedStyle(document.querySelector("[data-tool=disc]")).display), "none");
}

await test("the exported replay opens from disk and plays", async () => {
  await until(() => slalom.scalar("tick") > 80);
  const file = await saved(page, "#save-replay");
  const replay = await open("file://" + file);
  await plays(replay);
  if (pictures) await replay.screenshot({ path: `${pictures}/replay.png` });
  await replay.close();
});

await test("a recording saved from the page opens with slalom replay", async () => {
  const file = await saved(page, "#save-recording");
  const shown = await start("replay", file, "--port", "0"), replay = await open(shown.address);
  await plays(replay);
  await replay.close();
  await shown.stop();
});

await test("a recording of slalom drive becomes a page", async () => {
  const file = join(folder, "lap.mcap"), html = join(folder, "lap.html");
  execFileSync(program, ["drive", "--course", "wren", "--seed", "2", "--obstacles", "3", "--record", file], { stdio: "ignore" });
  execFileSync(program, ["replay", file, "--html", html], { stdio: "ignore" });
  const replay = await open("file://" + html);
  await plays(replay);
  await replay.close();
});

await test("an evaluation: a click on a collision shows the seconds before it", async () => {
  const out = join(folder, "evaluation");
  execFileSync(program, ["eval", "--course", "hare", "--methods", "mppi", "--laps", "3", "--obstacles", "6", "--config", "published", "--set", "mppi.samples=24", "--out", out], { stdio: "ignore" });
  const shown = await start("view", "--eval", out, "--port", "0"), look = await open(shown.address);
  const wait = (what, arg) => look.waitForFunction(what, arg, { timeout: 30000 });
  await wait(() => document.querySelector("#evaluation [data-contact]"));
  const contact = await look.getAttribute("#evaluation [data-contact]", "data-contact");
  await look.click("#evaluation [data-contact]");
  await wait((c) => slalom.state.contact && [slalom.state.contact.experiment, slalom.state.contact.lap, slalom.state.contact.contact].join("/") === c, contact);
  const tick = await look.evaluate(() => slalom.state.contact.tick);
  await wait((t) => slalom.scalar("tick") > 0 && slalom.scalar("tick") < t && slalom.scalar("contact") === 0, tick);
  await wait((t) => slalom.state.paused && slalom.scalar("tick") >= t && slalom.scalar("contacts") > 0, tick);
  if (pictures) await look.screenshot({ path: `${pictures}/evaluation.png` });
  await look.click("#timeline");
  const generation = await look.evaluate(() => slalom.state.generation);
  // Where the mark is on the page now: a note that comes or goes above the scene moves it.
  const mark = () => look.evaluate(() => {
    slalom.scene.fit();
    slalom.scene.draw();
    const m = slalom.scene.marks.at(-1), [x, y] = slalom.scene.camera.toScreen(m.x, m.y), box = document.querySelector("#scene").getBoundingClientRect();
    return [box.x + x, box.y + y];
  });
  let at = await mark();
  for (let before; String(before) !== String(at); at = await mark()) { before = at; await look.waitForTimeout(300); }
  await look.mouse.click(...at);
  await wait((g) => slalom.state.generation > g && slalom.state.contact, generation);
  await look.close();
  await shown.stop();
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
rmSync(folder, { recursive: true });
console.log(failed ? `${failed} failed` : "all passed");
process.exit(failed ? 1 : 0);
