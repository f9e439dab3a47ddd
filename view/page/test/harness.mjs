// The parts that all tests of the page share: the program as a server, Chromium, and waiting for conditions.
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

/** Starts the program and waits for its address. */
async function startProgram(program, args) {
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

export function chromiumPath() {
  const usual = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
  return process.env.SLALOM_CHROMIUM ?? usual.find(existsSync);
}

function launchChromium() {
  const args = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync"];
  args.push("--disable-background-networking", "--disable-component-update");
  // A page from a file has no local address.
  if (process.env.SLALOM_PAGE) args.push("--disable-features=LocalNetworkAccessChecks");
  return chromium.launch({ executablePath: chromiumPath(), timeout: patience, args });
}

/** One server with one open page, which the suites use in turn. */
export class Harness {
  failed = 0;
  problems = []; // errors in the consoles of all pages
  folder = mkdtempSync(join(tmpdir(), "slalom-view-"));

  constructor(program, only) {
    this.program = program;
    this.only = only;
  }

  /** Opens a page that shows the drive of a scenario. */
  async openAll(scenario, options) {
    await this.launch();
    this.server = await this.start("view", ...scenario, "--port", "0");
    this.page = await this.open(this.server.address, options);
  }

  async launch() {
    this.browser = await launchChromium();
  }

  start(...args) {
    return startProgram(this.program, args);
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
    return page;
  }

  scalar(name) {
    return this.page.evaluate((n) => slalom.scalar(n), name);
  }
  state(page = this.page) {
    return page.evaluate(() => slalom.state);
  }
  send(command, page = this.page) {
    return page.evaluate((c) => slalom.send(c), command);
  }
  until(what, arg, page = this.page) {
    return page.waitForFunction(what, arg, { timeout: patience });
  }

  /** The place on a page of a point of the map frame. */
  placeOf(page, x, y) {
    return page.evaluate(
      ([x, y]) => {
        const box = document.getElementById("scene").getBoundingClientRect();
        const [px, py] = slalom.scene.camera.toScreen(x, y);
        return [box.left + px, box.top + py];
      },
      [x, y],
    );
  }

  /** Starts the drive again and waits until the page has the state of the new one. */
  async restart(page = this.page) {
    await this.until(() => window.slalom?.state, null, page);
    const generation = await page.evaluate(() => slalom.state.generation);
    await this.send({ do: "restart" }, page);
    await this.until((g) => slalom.state.generation > g, generation, page);
  }
  /** Waits until the drive is paused and the page shows the server's tick. */
  async pause(page = this.page) {
    await this.send({ do: "pause" }, page);
    await this.until(() => slalom.state.paused && slalom.state.tick === slalom.scalar("tick"), null, page);
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
  async step(ticks, page = this.page) {
    const tick = await page.evaluate(() => slalom.scalar("tick"));
    await this.send({ do: "step", ticks }, page);
    const isThere = (t) => slalom.scalar("tick") === t && slalom.state.newest === t;
    await this.until(isThere, tick + ticks, page);
  }

  /** The rows and cells of what "Save as CSV" saves. */
  async csv(page = this.page) {
    const [file] = await Promise.all([page.waitForEvent("download"), page.click("#csv")]);
    const text = readFileSync(await file.path(), "utf8").trim();
    return text.split("\n").map((row) => row.split(","));
  }

  /** Waits until the page has drawn what it has received. */
  drawn(page = this.page) {
    return page.evaluate(
      () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))),
    );
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
