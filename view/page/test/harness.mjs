// What all tests of the page share: the program as a server, Chromium, and waiting for conditions.
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";

/**
 * How long a condition may take, ms. Tests wait for conditions and never for a time, so a slow machine only takes
 * longer; this bound ends a test whose condition will never hold. SLALOM_PATIENCE sets it.
 */
export const patience = Number(process.env.SLALOM_PATIENCE ?? 180_000);

/** Starts the program and waits for its address. */
export async function startProgram(program, args) {
  const child = spawn(program, args, { stdio: ["ignore", "pipe", "inherit"] });
  const address = await new Promise((resolve, reject) => {
    let said = "";
    child.stdout.on("data", (data) => { said += data; const found = said.match(/http:\S+/); if (found) resolve(found[0]); });
    child.on("exit", () => reject(new Error("slalom view ended: " + said)));
  });
  return { child, address, port: new URL(address).port, stop: () => new Promise((done) => { child.removeAllListeners("exit"); child.on("exit", done); child.kill("SIGTERM"); }) };
}

export function chromiumPath() {
  return process.env.SLALOM_CHROMIUM ?? ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
}

export function launchChromium() {
  return chromium.launch({
    executablePath: chromiumPath(),
    timeout: patience,
    args: ["--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
      ...(process.env.SLALOM_PAGE ? ["--disable-features=LocalNetworkAccessChecks"] : [])], // such a page has no local address
  });
}

/** One server with one open page, which the suites use in turn. */
export class Harness {
  failed = 0;
  problems = []; // errors in the consoles of all pages
  folder = mkdtempSync(join(tmpdir(), "slalom-view-"));

  constructor(program, pictures, only) {
    this.program = program;
    this.pictures = pictures;
    this.only = only;
  }

  async open_all() {
    this.browser = await launchChromium();
    this.server = await this.serve("--port", "0");
    this.page = await this.open();
  }

  start(...args) { return startProgram(this.program, args); }
  serve(...args) { return this.start("view", "--course", "stag", "--obstacles", "4", "--seed", "3", ...args); }

  /** A page whose errors are collected. SLALOM_PAGE names a file that is shown instead of the program's page. */
  async open(address, options = {}) {
    const page = await this.browser.newPage({ viewport: { width: 1280, height: 720 }, colorScheme: "dark", ...options });
    page.setDefaultTimeout(patience);
    page.on("console", (message) => message.type() === "error" && this.problems.push(message.text()));
    page.on("pageerror", (error) => this.problems.push(error.message));
    if (process.env.SLALOM_PAGE) await page.route((url) => url.protocol === "http:" && url.pathname === "/", (route) => route.fulfill({ path: process.env.SLALOM_PAGE, contentType: "text/html" }));
    if (address) await page.goto(address);
    return page;
  }

  scalar(name) { return this.page.evaluate((n) => slalom.scalar(n), name); }
  state() { return this.page.evaluate(() => slalom.state); }
  send(command) { return this.page.evaluate((c) => slalom.send(c), command); }
  until(what, arg, page = this.page) { return page.waitForFunction(what, arg, { timeout: patience }); }
  async picture(name, page = this.page) { if (this.pictures) await page.screenshot({ path: `${this.pictures}/${name}.png` }); }

  /** Starts the drive again and waits until the page has the state of the new one. */
  async restart() {
    await this.until(() => window.slalom?.state);
    const generation = (await this.state()).generation;
    await this.send({ do: "restart" });
    await this.until((g) => slalom.state.generation > g, generation);
  }

  /** Waits until the drive is paused and the page shows the server's tick. */
  async pause() {
    await this.send({ do: "pause" });
    await this.until(() => slalom.state.paused && slalom.state.tick === slalom.scalar("tick"));
  }
  /** Goes on, and waits until the page knows: a pause that follows would otherwise take the state before for its own. */
  async play() {
    await this.send({ do: "play" });
    await this.until(() => !slalom.state.paused);
  }
  /** Hides what is slow to draw without a graphics card, for tests that do not look at it. */
  hideLayers() { return this.page.evaluate(() => { slalom.scene.visible.clear(); }); }
  showLayers() { return this.page.evaluate(() => { for (const box of document.querySelectorAll("[data-layer]")) if (box.checked) slalom.scene.visible.add(box.dataset.layer); }); }

  /** Waits until the page has drawn what it has received. */
  drawn(page = this.page) { return page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))); }

  async test(name, body) {
    if (this.only && !name.includes(this.only)) return;
    const begin = Date.now();
    try {
      await body();
      console.log(`ok    ${name} (${((Date.now() - begin) / 1000).toFixed(1)} s)`);
    } catch (error) {
      this.failed += 1;
      console.log("FAIL  " + name + "\n      " + (error.stack ?? error).split("\n").join("\n      "));
      await this.picture("failed-" + this.failed);
    }
  }

  async close() {
    await this.browser.close();
    await this.server.stop();
    rmSync(this.folder, { recursive: true });
  }
}
