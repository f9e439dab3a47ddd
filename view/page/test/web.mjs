// Looks at the documentation site, and drives its demonstration, in Chromium: node test/web.mjs FOLDER
import assert from "node:assert/strict";
import { createReadStream, existsSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join } from "node:path";
import { Harness } from "./harness.mjs";
import { violations } from "./suites/accessible.mjs";

const folder = process.argv[2];
if (!folder || !existsSync(join(folder, "demo", "index.html"))) {
  console.error("usage: web.mjs FOLDER (which script/docs builds)");
  process.exit(2);
}
const types = {
  ".html": "text/html",
  ".js": "text/javascript",
  ".css": "text/css",
  ".png": "image/png",
  ".gif": "image/gif",
  ".svg": "image/svg+xml",
  ".wasm": "application/wasm",
};
const files = createServer((request, response) => {
  const path = new URL(request.url, "http://localhost").pathname;
  response.setHeader("content-type", types[extname(path)] ?? "text/plain");
  createReadStream(join(folder, path))
    .on("error", () => response.end())
    .pipe(response);
});
await new Promise((done) => files.listen(0, "127.0.0.1", done));

const h = new Harness();
await h.launch();
const site = `http://127.0.0.1:${files.address().port}/`;
h.page = (await h.open(site + "demo/index.html")).page;

await h.test("the demonstration drives by itself", async () => {
  await h.until(() => window.slalom?.state && slalom.scalar("tick") > 5);
  assert.equal((await h.state()).method, "svg_mppi");
});

await h.test("it solves at least 20 times a second", async () => {
  await h.send({ do: "rate", rate: 0 });
  const [from, begin] = [await h.scalar("tick"), Date.now()];
  await h.until((tick) => slalom.scalar("tick") >= tick + 40, from);
  const solves = (await h.scalar("tick")) - from;
  const rate = (1000 * solves) / (Date.now() - begin);
  console.log(
    `      ${rate.toFixed(0)} steps a second, ${(await h.scalar("tick_ms")).toFixed(1)} ms a solve`,
  );
  assert.ok(rate >= 20, `${rate} solves a second`);
  await h.send({ do: "rate", rate: 1 });
});

await h.test("an obstacle is dragged while the drive is paused, and the plan goes around it", async () => {
  await h.restart();
  const before = await h.page.evaluateHandle(() => slalom.frame);
  await h.until((frame) => slalom.frame !== frame && slalom.scalar("tick") > 7, before);
  await h.seek(7);
  await h.dragThroughPlan();
});

await h.test("methods and options change, and a wrong option is refused", async () => {
  await h.send({ do: "method", method: "mppi" });
  await h.until(() => slalom.state.method === "mppi");
  await h.send({ do: "set", key: "mppi.temperature", value: "0.5" });
  await h.until(() => slalom.scalar("temperature") === 0.5);
  const refused = await h.page.evaluate(() =>
    slalom.ask({ do: "set", key: "mppi.samples", value: "-1" }).catch((error) => error.message),
  );
  assert.match(refused, /must be in \[1, /);
});

await h.test("pages of the site fit a phone, are found, and have no violation in either theme", async () => {
  const found = [];
  for (const colorScheme of ["light", "dark"])
    for (const path of ["index.html", "docs/getting-started.html", "docs/results.html"]) {
      const { page } = await h.open(site + path, { viewport: { width: 360, height: 740 }, colorScheme });
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= 360), path);
      const width = await page.evaluate(() => document.querySelector("article p").clientWidth);
      assert.ok(width > 300, `${path}: a paragraph is ${width} px wide`);
      found.push(...(await violations(page)).map((each) => `${path}, ${colorScheme}: ${each}`));
      await page.close();
    }
  assert.deepEqual(found, []);
  const { page } = await h.open(site + "index.html");
  for (const demo of await page.locator(".demo").all()) {
    await demo.scrollIntoViewIfNeeded();
    await demo.contentFrame().locator("#cost").filter({ hasText: /\d/ }).waitFor({ state: "attached" });
  }
  await page.locator("[name=query]").pressSequentially("costmap");
  await page.locator(".md-search-result__item").first().waitFor();
});

await h.test("no errors are in the console", () => assert.deepEqual(h.problems, []));
await h.close();
files.close();
process.exit(h.failed ? 1 : 0);
