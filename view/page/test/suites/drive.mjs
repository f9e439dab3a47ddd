// The drive: time, obstacles, options.
import assert from "node:assert/strict";

export default async function (h) {
  const { page } = h;
  /** The scene as it is drawn. */
  const sceneBytes = () => page.evaluate(() => { slalom.scene.draw(); return document.getElementById("scene").toDataURL("image/png"); });

  await h.test("shows a moving labelled car", async () => {
    await h.until(() => window.slalom?.frame && slalom.scalar("speed") > 0.1 && document.getElementById("label").textContent.includes("svg_mppi"));
    const first = await h.scalar("x");
    await h.until((x) => Math.abs(slalom.scalar("x") - x) > 0.2, first);
  });

  await h.test("pauses, steps one tick, goes back and on", async () => {
    await h.until(() => slalom.scalar("tick") > 60);
    await page.click("#play");
    await h.until(() => slalom.state.paused && slalom.state.tick === slalom.scalar("tick"));
    const tick = await h.scalar("tick");
    await page.click("#step");
    await h.until((t) => slalom.scalar("tick") === t + 1, tick);
    const there = await h.scalar("x");
    await page.evaluate(() => { const t = document.getElementById("timeline"); t.value = String(slalom.scalar("tick") - 30); t.dispatchEvent(new Event("input")); t.dispatchEvent(new Event("change")); });
    await h.until((t) => slalom.scalar("tick") === t - 29, tick);
    await h.until(() => /earlier/.test(document.getElementById("mode-text").textContent));
    await h.send({ do: "step", ticks: 30 });
    await h.until((t) => slalom.scalar("tick") === t + 1, tick);
    assert.equal(await h.scalar("x"), there, "going back and on again ends at the same place, bit for bit");
  });

  await h.test("an obstacle dropped in the car's way changes the plan, in the data and in pixels", async () => {
    // The scan of a control step may be from before an edit: two steps later the obstacle has been seen.
    const step = async () => { const tick = await h.scalar("tick"); await h.send({ do: "step", ticks: 2 }); await h.until((t) => slalom.scalar("tick") === t + 2, tick); };
    /** The plan, and how near it comes to a place. */
    const nearest = (at) => page.evaluate((p) => Math.min(...slalom.frame.plan.map((s) => Math.hypot(s.x - p.x, s.y - p.y))), at);
    // At this tick of the seed's drive, no wall hides the end of the plan from the scanner.
    const at = 120, newest = (await h.state()).newest;
    if (newest < at) await h.send({ do: "step", ticks: at - newest });
    await h.until((t) => slalom.state.newest >= t, at);
    await h.send({ do: "seek", tick: at });
    await h.until((t) => slalom.scalar("tick") === t && slalom.state.tick === t, at);
    // Two ticks after this one, without the obstacle; going back and on again is exact.
    const tick = await h.scalar("tick");
    await step();
    const place = await page.evaluate(() => { const plan = slalom.frame.plan, p = plan[Math.round(0.6 * plan.length)]; return { x: p.x, y: p.y }; });
    const without = await nearest(place), pixels = await sceneBytes();
    await h.send({ do: "seek", tick });
    await h.until((t) => slalom.scalar("tick") === t && slalom.state.tick === t, tick);
    const bodies = await page.evaluate(() => slalom.frame.bodies.length);
    const [x, y] = await page.evaluate((p) => { slalom.scene.draw(); return slalom.scene.camera.toScreen(p.x, p.y); }, place);
    const box = await page.locator("#scene").boundingBox();
    assert.equal(await page.evaluate(([px, py]) => document.elementFromPoint(px, py).id, [box.x + x, box.y + y]), "scene", "nothing covers the plan");
    await page.mouse.click(box.x + x, box.y + y);
    await h.until((n) => slalom.frame.bodies.length === n + 1, bodies);
    await step();
    const radius = await page.evaluate(() => slalom.frame.bodies.at(-1).length / 2);
    assert.ok((await nearest(place)) > without + radius, `the plan still leads within ${await nearest(place)} m of the obstacle`);
    assert.notEqual(await sceneBytes(), pixels);
    await h.picture("avoidance");
  });

  await h.test("an obstacle can be dragged and removed", async () => {
    const body = await page.evaluate(() => slalom.frame.bodies.at(-1));
    const box = await page.locator("#scene").boundingBox();
    const [x, y] = await page.evaluate((b) => slalom.scene.camera.toScreen(b.x, b.y), body);
    await page.mouse.move(box.x + x, box.y + y);
    await page.mouse.down();
    await page.mouse.move(box.x + x + 40, box.y + y + 10, { steps: 6 });
    await page.mouse.up();
    await h.until((b) => { const now = slalom.frame.bodies.find((o) => o.id === b.id); return Math.hypot(now.x - b.x, now.y - b.y) > 0.2; }, body);
    const [nx, ny] = await page.evaluate((id) => { const b = slalom.frame.bodies.find((o) => o.id === id); return slalom.scene.camera.toScreen(b.x, b.y); }, body.id);
    await page.mouse.click(box.x + nx, box.y + ny, { button: "right" });
    await h.until((id) => !slalom.frame.bodies.some((o) => o.id === id), body.id);
  });

  await h.test("switches to mppi and back", async () => {
    await page.click("#play");
    await page.selectOption("#method", "mppi");
    await h.until(() => slalom.hello.methods[slalom.scalar("method")] === "mppi" && slalom.state.method === "mppi");
    assert.equal(await page.evaluate(() => slalom.frame.guides), undefined);
    await page.selectOption("#method", "svg_mppi");
    await h.until(() => slalom.hello.methods[slalom.scalar("method")] === "svg_mppi" && slalom.frame.guides);
  });

  await h.test("a slider changes the option in the solver, and undo takes it back", async () => {
    const before = await h.scalar("samples");
    await page.click('nav button[data-pane="options"]');
    await page.evaluate(() => { const s = document.querySelector('[data-key="svg_mppi.samples"] input[type=range]'); s.value = "0.4"; s.dispatchEvent(new Event("input")); s.dispatchEvent(new Event("change")); });
    await h.until((n) => slalom.scalar("samples") !== n && slalom.scalar("samples") > 0, before);
    await h.until(() => /--set 'svg_mppi\.samples=\d+'/.test(document.getElementById("command").textContent));
    await h.picture("options");
    await page.click("#undo");
    await h.until((n) => slalom.scalar("samples") === n, before);
    await page.click('nav button[data-pane="charts"]');
  });

  await h.test("a value out of range is refused with the rule", async () => {
    await h.send({ do: "set", key: "svg_mppi.samples", value: "0" });
    await h.until(() => /must be in/.test(document.getElementById("toast").textContent));
  });

  await h.test("opponents drive along the line", async () => {
    await h.send({ do: "scenario", opponents: 2 });
    await h.until(() => slalom.state.opponents === 2 && slalom.frame.bodies.filter((b) => b.kind === 4).length === 2);
    const first = await page.evaluate(() => slalom.frame.bodies.find((b) => b.kind === 4).x);
    await h.until((x) => Math.abs(slalom.frame.bodies.find((b) => b.kind === 4).x - x) > 0.3, first);
    await h.send({ do: "scenario", opponents: 0 });
    await h.until(() => slalom.state.opponents === 0);
  });

  await h.test("a caption says when the controller averages two ways, and when it commits to one", async () => {
    await h.send({ do: "scenario", config: "published", method: "mppi", obstacles: 0, seed: "0" });
    await h.until(() => slalom.state.config === "published" && slalom.state.obstacles === 0);
    await h.until(() => slalom.state.newest > 2);
    await h.pause();
    await h.send({ do: "seek", tick: 0 });
    await h.until(() => slalom.scalar("tick") === 0);
    await h.send({ do: "set", key: "mppi.variance", value: "0.1" });
    // A parked car in the middle of the straight, 8 m along the course line.
    const [x, y, yaw] = await page.evaluate(() => slalom.scene.alongPath(8));
    await h.send({ do: "add", kind: "car", x, y, yaw });
    const said = new Set();
    for (let step = 0; step < 90 && !said.has("commits"); ++step) {
      const tick = await h.scalar("tick");
      await h.send({ do: "step" });
      await h.until((t) => slalom.scalar("tick") === t + 1, tick);
      const text = await page.evaluate(() => document.getElementById("modes").textContent);
      if (/mppi averages: .* leads into/.test(text)) { said.add("averages"); await h.picture("averages"); }
      if (said.has("averages") && /mppi commits: /.test(text)) said.add("commits");
    }
    assert.deepEqual([...said], ["averages", "commits"]);
    await h.picture("commits");
    await h.send({ do: "scenario", config: "default", method: "svg_mppi", obstacles: 4, seed: "3" });
    await h.until(() => slalom.state.config === "default" && slalom.state.seed === "3" && slalom.scalar("tick") > 3);
  });
}
