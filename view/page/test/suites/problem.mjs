// A problem of the user's own on the page.
import assert from "node:assert/strict";
import { createServer } from "node:http";

const ofCar = ["course", "tab-laps", "nudge-left", "speed"]; // parts of the page

export default async function (h) {
  let server = await h.start("view", "--problem", "differential_drive", "--port", "0");
  const look = await h.open(server.address);
  const { page } = look;
  await look.until(() => window.slalom?.state && slalom.scalar("tick") > 5);

  await h.test("a problem has its own charts, options and names", async () => {
    const charts = await page.locator("#charts h2").allTextContents();
    for (const name of ["Cost of the plan", "Speed, m/s", "X · y, m", "Yaw, rad"]) {
      const isThere = charts.some((text) => text.startsWith(name));
      assert.ok(isThere, `${name} in ${charts}`);
    }
    for (const id of ofCar) assert.equal(await page.isVisible("#" + id), false, id);
    assert.equal(await page.isVisible("#cost"), true);
    await page.click("#tab-options");
    await page.click("#all-options");
    for (const key of ["svg_mppi.samples", "problem.goal_x"])
      assert.equal(await page.locator(`[data-key="${key}"]`).count(), 1, key);
    await page.click("#tab-charts");
  });

  await h.test("the help and the keys are those of a problem", async () => {
    await page.click("#help");
    const keys = await page.locator("#keys dt:visible").allTextContents();
    const has = (key) => keys.some((text) => text.startsWith(key));
    assert.ok(has("Space") && !has("["), keys);
    await page.click("#help-box button");
    await page.keyboard.press("1");
    assert.equal(await page.evaluate(() => document.querySelector("[data-tool].on").dataset.tool), "pan");
  });

  await h.test("a page with a solver inside shows nothing of a car before it has begun", async () => {
    const { page: inside } = await h.open();
    const text = await page.evaluate(() => fetch("/").then((answer) => answer.text()));
    const body = text.replace("<meta name", '<meta name="solver" content="solver.js" /><meta name');
    await inside.route("**/*", (route) =>
      route.request().url().endsWith("solver.js")
        ? route.fulfill({ body: "", contentType: "text/javascript" })
        : route.fulfill({ body, contentType: "text/html" }),
    );
    await inside.goto("http://localhost/demo");
    await inside.locator("#theme").waitFor();
    for (const id of [...ofCar, "save-recording", "config"])
      assert.equal(await inside.isVisible("#" + id), false, id);
    await inside.close();
  });

  await h.test("an obstacle is dragged while the drive is paused, and the plan goes around it", async () => {
    await look.restart();
    const before = await page.evaluateHandle(() => slalom.frame);
    await look.until((frame) => slalom.frame !== frame && slalom.scalar("tick") > 7, before);
    await look.seek(7);
    await look.dragThroughPlan();
    assert.equal(await look.scalar("tick"), 7);
  });

  await h.test("what is drawn has the scale of the problem, from 1 cm to 100 km", async () => {
    await look.send({ do: "set", key: "problem.goal_x", value: "100000" });
    await look.until(() => slalom.state.bounds[2] > 1e5);
    await page.click("[data-follow=fit]");
    await look.until(() => document.getElementById("ruler-text").textContent.endsWith(" km"));
    const [x, y] = await page.evaluate(() => slalom.stage.camera.toScreen(1e5, 0));
    const { width, height } = await page.evaluate(() => slalom.stage.size);
    assert.ok(x > 0 && x < width && y > 0 && y < height, `the goal is at ${x}, ${y}`);
    await look.send({ do: "undo" });
    await look.until(() => slalom.frame.bodies.some((b) => b.kind === 6 && b.x === 8));
    const text = await page.evaluate(() => {
      const { camera, ...stage } = slalom.stage;
      camera.fit(0, 0, 0.01, 0.005);
      const shown = camera.toScreen(0.01, 0)[0] - camera.toScreen(0, 0)[0];
      stage.zoom(1.1);
      return [shown > 300, camera.zoom * 0.01 > shown];
    });
    assert.deepEqual(text, [true, true]);
    await look.until(() => document.getElementById("ruler-text").textContent.endsWith(" mm"));
    await look.restart();
    await page.click("[data-follow=fit]");
  });

  await h.test("a second method and captions are there for a problem, and its goal is dragged", async () => {
    const two = await h.start("view", "--problem", "differential_drive", "--against", "mppi", "--port", "0");
    const both = await h.open(two.address);
    await both.until(() => window.slalom?.frame?.ghostFrame && slalom.scalar("tick") >= 5);
    await both.seek(3);
    await both.drawn();
    const captions = both.page.locator(".caption");
    const verdicts = await captions.evaluateAll((all) => all.map((e) => e.dataset.verdict));
    assert.deepEqual(verdicts, ["commits", "averages"]);
    const goal = await both.page.evaluate(() => slalom.frame.bodies.find((b) => b.kind === 6));
    assert.deepEqual([goal.x, goal.y], [8, 0]);
    await both.drag(await both.placeOf(goal), await both.placeOf({ x: 7, y: 1 }));
    await both.until(() => Math.abs(slalom.frame.bodies.find((b) => b.kind === 6).y - 1) < 0.1);
    await both.page.close();
    await two.stop();
  });

  await h.test("method, options and parameters change, and can be reset", async () => {
    await page.selectOption("#method", "mppi");
    await look.until(() => slalom.state.method === "mppi");
    await look.send({ do: "set", key: "problem.goal_x", value: "6" });
    await look.send({ do: "set", key: "mppi.samples", value: "200" });
    await look.until(() => slalom.scalar("samples") === 200);
    await look.send({ do: "reset_options" });
    await look.until(() => slalom.scalar("samples") === 1024);
    await look.send({ do: "method", method: "svg_mppi" });
    await look.until(() => slalom.state.method === "svg_mppi");
  });

  await h.test("charts hide lines, zoom, and have a logarithmic axis", async () => {
    await page.click("#tab-charts");
    const line = page.locator("#charts button.value").first();
    await line.click();
    assert.equal(await line.getAttribute("aria-pressed"), "false");
    await line.click();
    await page.check("#log");
    const chart = page.locator("#charts .u-over").nth(1);
    await chart.scrollIntoViewIfNeeded();
    const box = await chart.boundingBox();
    const at = (share) => [box.x + share * box.width, box.y + 20];
    await look.drag(at(0.2), at(0.6));
    await page.locator("#zoom-out").waitFor();
    const begin = async () => Number((await look.csv())[1][1]);
    const zoomed = await begin();
    await page.click("#later");
    const later = await begin();
    assert.ok(later > zoomed, `${later} s is after ${zoomed} s`);
    await page.click("#earlier");
    assert.ok(Math.abs((await begin()) - zoomed) < 0.11, "as far back as it went on");
    await page.locator("#toast").waitFor({ state: "hidden" });
    await look.send({ do: "restart" });
    await page.locator("#zoom-out").waitFor({ state: "hidden" });
  });

  await h.test("another server on the same port is shown as what it is", async () => {
    const port = String(server.port);
    const problems = h.problems.length;
    await server.stop();
    server = await h.start("view", "--course", "wren", "--obstacles", "0", "--port", port);
    const shows = ([title, isCourse]) =>
      window.slalom?.hello?.title === title &&
      slalom.frame &&
      document.getElementById("course").checkVisibility() === isCourse;
    await look.until(shows, ["wren", true]);
    await server.stop();
    server = await h.start("view", "--problem", "cart_pole", "--port", port);
    await look.until(shows, ["cart_pole", false]);
    h.problems.length = problems; // Chromium reports the attempts to connect in the console
  });

  await h.test("bodies that cannot be moved are not dragged", async () => {
    await look.pause();
    const box = await page.evaluate(() => slalom.frame.bodies[1]);
    const [x, y] = await look.placeOf(box);
    await page.mouse.move(x, y);
    assert.equal(await page.evaluate(() => document.getElementById("scene").style.cursor), "default");
    await look.drag([x, y], [x + 40, y]);
    await look.drawn();
    assert.ok((await look.placeOf(box))[0] > x + 20, "the scene is moved instead");
    assert.equal(await page.isVisible("#toast"), false);
  });

  await h.test("a page of another address shows the problem inside, as a notebook does", async () => {
    const around = createServer((_, to) => {
      to.setHeader("content-type", "text/html").end(`<iframe src="${server.address}"></iframe>`);
    });
    await new Promise((done) => around.listen(0, "127.0.0.1", done));
    await page.goto(`http://localhost:${around.address().port}`);
    await page.frameLocator("iframe").locator("#scene").waitFor();
    around.close();
  });
  await page.close();
  await server.stop();
}
