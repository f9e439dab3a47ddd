// The parts that all tests of the page share: the program as a server, Chromium, and waiting for conditions.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";

/**
 * The time that a condition may take, ms. Tests wait for conditions and never for a time, so a slow machine
 * only takes longer; this bound ends a test whose condition will never hold. SLALOM_PATIENCE sets it.
 */
export const patience = Number(process.env.SLALOM_PATIENCE ?? 180_000);

export function chromiumPath() {
  const usual = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
  return process.env.SLALOM_CHROMIUM ?? usual.find(existsSync);
}

/** A page of the program, and what the tests do with it. */
export class Tab {
  constructor(page) {
    this.page = page;
  }

  scalar(name) {
    return this.page.evaluate((n) => slalom.scalar(n), name);
  }
  state() {
    return this.page.evaluate(() => slalom.state);
  }
  send(command) {
    return this.page.evaluate((c) => slalom.send(c), command);
  }
  until(what, arg) {
    return this.page.waitForFunction(what, arg, { timeout: patience });
  }
  /** Waits until the text of an element contains words. */
  says(id, words) {
    return this.until(([i, w]) => document.getElementById(i).textContent.includes(w), [id, words]);
  }
  /** Waits until an element is hidden, or not. */
  hides(id, isHidden = true) {
    return this.until(([i, is]) => document.getElementById(i).hidden === is, [id, isHidden]);
  }
  /** Clicks an element wherever it is. */
  press(id) {
    return this.page.evaluate((i) => document.getElementById(i).click(), id);
  }

  /** The place on the page of a point of the map frame. */
  placeOf({ x, y }) {
    return this.page.evaluate(
      ([x, y]) => {
        slalom.scene.drawScene();
        const box = document.getElementById("scene").getBoundingClientRect();
        const [px, py] = slalom.stage.camera.toScreen(x, y);
        return [box.left + px, box.top + py];
      },
      [x, y],
    );
  }
  /** Drags with the mouse between two places on the page. */
  async drag(from, to) {
    await this.page.mouse.move(...from);
    await this.page.mouse.down();
    await this.page.mouse.move(...to, { steps: 5 });
    await this.page.mouse.up();
  }
  /** Drags the first obstacle to both sides of the plan, and checks that the plan goes around it. */
  async dragThroughPlan() {
    for (const side of [0.5, -0.5]) {
      const body = await this.page.evaluate(() => slalom.frame.bodies[1]);
      await this.drag(await this.placeOf(body), await this.placeOf({ x: 2, y: side }));
      await this.until((y) => Math.abs(slalom.frame.bodies[1].y - y) < 0.1, side);
      const gap = await this.page.evaluate(() => {
        const disc = slalom.frame.bodies[1];
        const gaps = slalom.frame.plan.map((p) => Math.hypot(p.x - disc.x, p.y - disc.y));
        return Math.min(...gaps) / (disc.length / 2);
      });
      assert.ok(gap > 0.98, `the plan passes the disc at ${gap} of its radius`);
    }
  }
  /** Starts the drive again and waits until the page has the state of the new one. */
  async restart() {
    await this.until(() => window.slalom?.state);
    const { generation } = await this.state();
    await this.send({ do: "restart" });
    await this.until((g) => slalom.state.generation > g, generation);
  }
  /** Waits until the drive is paused and the page shows the server's tick. */
  isPaused() {
    return this.until(() => slalom.state.paused && slalom.state.tick === slalom.scalar("tick"));
  }
  async pause() {
    await this.send({ do: "pause" });
    await this.isPaused();
  }
  /** Goes on, and waits until the page knows. */
  async play() {
    await this.send({ do: "play" });
    await this.until(() => !slalom.state.paused);
  }
  /** Shows a tick and waits until the page does. */
  async seek(tick) {
    await this.send({ do: "seek", tick });
    await this.until((t) => slalom.scalar("tick") === t && slalom.state.tick === t, tick);
  }
  /** Drives some ticks from the one that is shown, and waits until the page shows the last of them. */
  async step(ticks) {
    const tick = await this.scalar("tick");
    await this.send({ do: "step", ticks });
    const isThere = (t) => slalom.scalar("tick") === t && slalom.state.tick === t;
    await this.until(isThere, tick + ticks);
  }

  /** Clicks a button that saves a file, and returns the file. The first download sometimes has no event. */
  async saved(id) {
    const click = () =>
      Promise.all([this.page.waitForEvent("download", { timeout: 30_000 }), this.page.click(id)]);
    const [file] = await click().catch(click);
    return file;
  }
  /** The rows and cells of what "Save as CSV" saves. */
  async csv() {
    const text = readFileSync(await (await this.saved("#csv")).path(), "utf8").trim();
    return text.split("\n").map((row) => row.split(","));
  }

  /** Waits until the page has drawn what it has received. */
  drawn() {
    return this.page.evaluate(
      () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))),
    );
  }
}

/** One server with one open page, which the suites use in turn. */
export class Harness extends Tab {
  failed = 0;
  problems = []; // errors in the consoles of all pages
  folder = mkdtempSync(join(tmpdir(), "slalom-view-"));

  constructor(program, only) {
    super();
    this.program = program;
    this.only = only;
  }

  /** Opens a page that shows the drive of a scenario. */
  async openAll(scenario, options) {
    await this.launch();
    this.server = await this.start("view", ...scenario, "--port", "0");
    this.page = (await this.open(this.server.address, options)).page;
  }

  async launch() {
    const args = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync"];
    args.push("--disable-background-networking", "--disable-component-update");
    // A page from a file has no local address.
    if (process.env.SLALOM_PAGE) args.push("--disable-features=LocalNetworkAccessChecks");
    this.browser = await chromium.launch({ executablePath: chromiumPath(), timeout: patience, args });
  }

  /** Starts the program and waits for its address. */
  start(...args) {
    return this.run(this.program, args);
  }
  async run(program, args) {
    const child = spawn(program, args, { stdio: ["ignore", "pipe", "inherit"] });
    const address = await new Promise((resolve, reject) => {
      let said = "";
      child.stdout.on("data", (data) => {
        said += data;
        const found = said.match(/http:\S+/);
        if (found) resolve(found[0]);
      });
      child.on("exit", () => reject(new Error("slalom view ended: " + said)));
    });
    const stop = () =>
      new Promise((done) => {
        child.removeAllListeners("exit");
        child.on("exit", done);
        child.kill("SIGTERM");
      });
    return { address, port: new URL(address).port, stop };
  }

  /** A page whose errors are collected. SLALOM_PAGE names a file that is shown instead of the program's. */
  async open(address, options = {}) {
    const viewport = { width: 1280, height: 720 };
    const page = await this.browser.newPage({ viewport, colorScheme: "dark", ...options });
    page.setDefaultTimeout(patience);
    page.on("console", (message) => message.type() === "error" && this.problems.push(message.text()));
    page.on("pageerror", (error) => this.problems.push(error.message));
    const path = process.env.SLALOM_PAGE;
    const isPage = (url) => url.protocol === "http:" && url.pathname === "/";
    if (path) await page.route(isPage, (route) => route.fulfill({ path, contentType: "text/html" }));
    if (address) await page.goto(address);
    return new Tab(page);
  }

  async test(name, body) {
    if (this.only && !name.includes(this.only)) return;
    const begin = Date.now();
    try {
      await body();
      console.log(`ok    ${name} (${((Date.now() - begin) / 1000).toFixed(1)} s)`);
    } catch (error) {
      this.failed += 1;
      console.log("FAIL  " + name + "\n      " + (error.stack ?? error).split("\n").join("\n      "));
    }
  }

  async close() {
    await this.browser.close();
    await this.server?.stop();
    rmSync(this.folder, { recursive: true });
  }
}
