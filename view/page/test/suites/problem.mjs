// A problem of the user's own on the page, and the inspection of candidates.
import assert from "node:assert/strict";
import { createServer } from "node:http";

export default async function (h) {
  let server = await h.start("view", "--problem", "differential_drive", "--port", "0");
  const look = await h.open(server.address);
  await h.until(() => window.slalom?.state && slalom.scalar("tick") > 5, null, look);

  await h.test("a problem has its own charts, options and names", async () => {
    const charts = await look.locator("#charts h2").allTextContents();
    for (const name of ["Cost of the plan", "Speed, m/s", "X · y, m", "Yaw, rad"])
      assert.ok(
        charts.some((text) => text.startsWith(name)),
        `${name} in ${charts}`,
      );
    for (const id of ["course", "ghost", "fork", "tab-laps", "nudge-left", "speed"])
      assert.equal(await look.locator("#" + id).isVisible(), false, id);
    assert.equal(await look.locator("#cost").isVisible(), true);
    await look.locator("#tab-options").click();
    await look.locator("#all-options").click();
    for (const key of ["svg_mppi.samples", "problem.goal_x"])
      assert.equal(await look.locator(`[data-key="${key}"]`).count(), 1, key);
    await look.locator("#tab-charts").click();
  });

  await h.test("the help and the keys are those of a problem", async () => {
    await look.locator("#help").click();
    const keys = await look.locator("#keys dt:visible").allTextContents();
    assert.ok(
      keys.some((text) => text.startsWith("Space")) && !keys.some((text) => text.startsWith("[")),
      keys,
    );
    await look.locator("#help-box button").click();
    const tool = () => look.evaluate(() => document.querySelector("[data-tool].on").dataset.tool);
    await look.keyboard.press("1");
    assert.equal(await tool(), "pan");
  });

  await h.test("a page with a solver inside shows nothing of a car before it has begun", async () => {
    const page = await h.open();
    const text = await look.evaluate(() => fetch("/").then((answer) => answer.text()));
    const body = text.replace("<meta name", '<meta name="solver" content="solver.js" /><meta name');
    await page.route("**/*", (route) =>
      route.request().url().endsWith("solver.js")
        ? route.fulfill({ body: "", contentType: "text/javascript" })
        : route.fulfill({ body, contentType: "text/html" }),
    );
    await page.goto("http://localhost/demo");
    await page.locator("#method").waitFor();
    for (const id of [
      "course",
      "ghost",
      "fork",
      "tab-laps",
      "nudge-left",
      "speed",
      "save-recording",
      "config",
    ])
      assert.equal(await page.locator("#" + id).isVisible(), false, id);
    const layers = await page.locator("#layer-list label:visible").allTextContents();
    assert.ok(layers.includes("Candidates") && !layers.includes("LiDAR"), layers.join());
    assert.equal(await page.locator('[data-follow="fit"]').textContent(), "Fit");
    await page.close();
  });

  await h.test("an obstacle is dragged while the drive is paused, and the plan goes around it", async () => {
    await h.restart(look);
    const before = await look.evaluateHandle(() => slalom.frame);
    await h.until((frame) => slalom.frame !== frame && slalom.scalar("tick") > 7, before, look);
    await h.send({ do: "seek", tick: 7 }, look);
    await h.until(() => slalom.state.tick === 7 && slalom.scalar("tick") === 7, null, look);
    const gap = () =>
      look.evaluate(() => {
        const disc = slalom.frame.bodies[1];
        return (
          Math.min(...slalom.frame.plan.map((p) => Math.hypot(p.x - disc.x, p.y - disc.y))) /
          (disc.length / 2)
        );
      });
    for (const side of [0.5, -0.5]) {
      const [from, to] = [
        await h.placeOf(
          look,
          ...(await look.evaluate(() => [slalom.frame.bodies[1].x, slalom.frame.bodies[1].y])),
        ),
        await h.placeOf(look, 2, side),
      ];
      await look.mouse.move(...from);
      await look.mouse.down();
      await look.mouse.move(...to, { steps: 4 });
      await look.mouse.up();
      await h.until((y) => Math.abs(slalom.frame.bodies[1].y - y) < 0.1, side, look);
      assert.equal(await look.evaluate(() => slalom.scalar("tick")), 7);
      assert.ok((await gap()) > 0.98, `the plan passes the disc at ${await gap()} of its radius`);
    }
  });

  await h.test("method, options and parameters change, and can be reset", async () => {
    await look.locator("#method").selectOption("mppi");
    await h.until(() => slalom.state.method === "mppi", null, look);
    await h.send({ do: "set", key: "problem.goal_x", value: "6" }, look);
    await h.send({ do: "set", key: "mppi.samples", value: "200" }, look);
    await h.until(() => slalom.scalar("samples") === 200, null, look);
    await h.send({ do: "reset_options" }, look);
    await h.until(() => slalom.scalar("samples") === 1024, null, look);
    await h.send({ do: "method", method: "svg_mppi" }, look);
    await h.until(() => slalom.state.method === "svg_mppi", null, look);
  });

  await h.test("a past step is shown again, and the drive goes on from there exactly", async () => {
    await h.restart(look);
    await h.until(() => slalom.scalar("tick") > 20, null, look);
    await h.send({ do: "pause" }, look);
    await h.until(() => slalom.state.paused, null, look);
    const at = (tick) => h.until((t) => slalom.scalar("tick") === t && slalom.state.tick === t, tick, look);
    const x = () => look.evaluate(() => slalom.scalar("x"));
    await h.send({ do: "seek", tick: 18 }, look);
    await at(18);
    const before = await x();
    await h.send({ do: "seek", tick: 7 }, look);
    await at(7);
    await h.send({ do: "step", ticks: 11 }, look);
    await at(18);
    assert.equal(await x(), before);
  });

  await h.test("a click on a candidate shows its rank, weight, cost by term and collision", async () => {
    const middle = await look.evaluate(() => {
      const c = slalom.frame.candidates;
      const i = c.collided.findIndex((v) => v > 8);
      const k = Math.max(0, i) * c.points + Math.round(0.7 * c.points);
      return [c.xy[2 * k], c.xy[2 * k + 1]];
    });
    await look.mouse.click(...(await h.placeOf(look, ...middle)));
    await look.locator("#pane-inspect").waitFor();
    const text = await look.locator("#inspect-text").textContent();
    assert.match(text, /^Rank \d+ of \d+ by cost, weight [\d.e-]+ %\. It (does not collide|collides)/);
    const rows = await look.locator("#inspect-terms tr").allTextContents();
    assert.ok(rows.length >= 2 && rows.at(-1).startsWith("total"), rows.join());
    assert.equal(await look.locator("#inspect-charts .chart:visible canvas").count(), 6);
    // By rank: the cost of the candidate is the sum of its terms, as the solver has it, but for float32.
    await look.locator("#rank").fill("1");
    await look.locator("#rank").press("Tab");
    const [sum, cost] = await look.evaluate(() => {
      const { candidates: c } = slalom.frame;
      const i = slalom.scene.chosen;
      const terms = c.terms.slice(c.width * i, c.width * (i + 1) - 2);
      return [terms.reduce((a, b) => a + b), c.terms[c.width * (i + 1) - 2]];
    });
    assert.ok(Math.abs(sum - cost) < 1e-3 * cost, `${sum} is ${cost}`);
  });

  await h.test(
    "a candidate that is chosen while driving stays, and is forgotten with a new plan",
    async () => {
      await h.send({ do: "rate", rate: 0 }, look);
      await h.restart(look);
      await h.until(() => !slalom.state.paused && slalom.scalar("tick") > 5, null, look);
      await look.locator("#rank").fill("3");
      await look.locator("#rank").press("Tab");
      await h.until(() => slalom.state.paused && slalom.scalar("tick") === slalom.state.tick, null, look);
      await h.drawn(look);
      assert.match(await look.locator("#inspect-text").textContent(), /^Rank 3 of/);
      assert.ok(await look.evaluate(() => slalom.scene.chosen >= 0));
      await h.send({ do: "set", key: "problem.goal_y", value: "1" }, look);
      await h.until(() => slalom.scene.chosen < 0, null, look);
      await h.send({ do: "rate", rate: 1 }, look);
    },
  );

  await h.test("charts hide lines, zoom, and have a logarithmic axis", async () => {
    await look.locator("#tab-charts").click();
    const line = look.locator("#charts button.value").first();
    await line.click();
    assert.equal(await line.getAttribute("aria-pressed"), "false");
    await line.click();
    await look.locator("#log").check();
    const box = await look.locator("#charts .u-over").nth(1).boundingBox();
    await look.mouse.move(box.x + 0.2 * box.width, box.y + 20);
    await look.mouse.down();
    await look.mouse.move(box.x + 0.6 * box.width, box.y + 20, { steps: 5 });
    await look.mouse.up();
    await look.locator("#zoom-out").waitFor();
    const begin = async () => {
      const rows = await h.csv(look);
      return Number(rows[1][1]);
    };
    const zoomed = await begin();
    await look.locator("#later").click();
    const later = await begin();
    assert.ok(later > zoomed, `${later} s is after ${zoomed} s`);
    await look.locator("#earlier").click();
    assert.ok(Math.abs((await begin()) - zoomed) < 0.11, "as far back as it went on");
    await look.locator("#toast").waitFor({ state: "hidden" });
    await h.send({ do: "restart" }, look);
    await look.locator("#zoom-out").waitFor({ state: "hidden" });
  });
  await h.test("another server on the same port is shown as what it is", async () => {
    const port = String(server.port);
    const problems = h.problems.length;
    await server.stop();
    server = await h.start("view", "--course", "wren", "--obstacles", "0", "--port", port);
    const shows = ([course, own]) =>
      window.slalom?.state?.course === course && slalom.frame && document.body.matches(".own") === own;
    await h.until(shows, ["wren", false], look);
    await server.stop();
    server = await h.start("view", "--problem", "cart_pole", "--port", port);
    await h.until(shows, ["cart_pole", true], look);
    h.problems.length = problems; // Chromium reports the attempts to connect in the console
  });

  await h.test("bodies that cannot be moved are not dragged", async () => {
    await h.pause(look);
    const box = await look.evaluate(() => slalom.frame.bodies[1]);
    const from = await h.placeOf(look, box.x, box.y);
    await look.mouse.move(...from);
    assert.equal(await look.evaluate(() => document.getElementById("scene").style.cursor), "default");
    await look.mouse.down();
    await look.mouse.move(from[0] + 40, from[1], { steps: 4 });
    await look.mouse.up();
    await h.drawn(look);
    const [x] = await h.placeOf(look, box.x, box.y);
    assert.ok(x > from[0] + 20, "the scene is moved instead");
    const toast = look.locator("#toast");
    assert.equal((await toast.isVisible()) && (await toast.textContent()), false);
  });

  await h.test("a page of another address shows the problem inside, as a notebook does", async () => {
    const around = createServer((_, to) => {
      to.setHeader("content-type", "text/html").end(`<iframe src="${server.address}"></iframe>`);
    });
    await new Promise((done) => around.listen(0, "127.0.0.1", done));
    await look.goto(`http://localhost:${around.address().port}`);
    await look.frameLocator("iframe").locator("#scene").waitFor();
    around.close();
  });
  await look.close();
  await server.stop();

  await h.test("a candidate of a car can be chosen by its rank, and its collision is marked", async () => {
    await h.pause();
    await h.page.locator("#tab-inspect").click();
    await h.page.locator("#rank").fill("3");
    await h.page.locator("#rank").press("Tab");
    await h.until(() => /^Rank 3 of/.test(document.getElementById("inspect-text").textContent));
    const rows = await h.page.locator("#inspect-terms tr").allTextContents();
    assert.deepEqual(
      rows.map((text) => text.replace(/[\d.–-].*/, "")),
      ["distance", "yaw", "collision", "total"],
    );
    // One that collides: the costs over the horizon are those of its terms, to a byte's precision.
    const rank = await h.page.evaluate(() => {
      const c = slalom.frame.candidates;
      const cost = (i) => c.terms[c.width * (i + 1) - 2];
      const order = Array.from({ length: c.count }, (_, i) => i).sort((a, b) => cost(a) - cost(b));
      return 1 + order.findIndex((i) => c.collided[i] > 1);
    });
    assert.ok(rank > 0, "a candidate collides");
    await h.page.locator("#rank").fill(String(rank));
    await h.page.locator("#rank").press("Tab");
    const says = /^Rank \d+ of .* It collides with (a parked car|a wall) after [\d.]+ s, at the cross\.$/;
    await h.until(
      (r) => new RegExp(r).test(document.getElementById("inspect-text").textContent),
      says.source,
    );
    const differences = await h.page.evaluate(() => {
      const { candidates: c, stepCosts: s } = slalom.frame;
      const i = slalom.scene.chosen;
      return [0, 1, 2].map((k) => {
        const at = (p) => s.costs[((1 + i) * s.points + p) * s.terms + k];
        const values = Array.from({ length: s.points }, (_, p) => at(p));
        const sum = values.reduce((a, b) => a + b);
        return Math.abs(sum - c.terms[c.width * i + k]) - (s.points / 510) * Math.max(...values);
      });
    });
    for (const each of differences) assert.ok(each < 1e-4, differences.join());
    const effective = await h.page.evaluate(() => [...slalom.frame.effectiveSamples]);
    const [temperature, size] = [await h.scalar("temperature"), await h.scalar("effective_samples")];
    const at = effective.findIndex((v, i) => i % 2 === 0 && Math.abs(v - temperature) < 1e-4 * v);
    assert.ok(Math.abs(effective[at + 1] - size) < 0.01 * size, `${effective} at ${temperature}: ${size}`);
    assert.equal(await h.page.locator("#inspect-charts .chart:visible canvas").count(), 6);
    await h.page.locator("#tab-charts").click();
    await h.play();
  });
}
