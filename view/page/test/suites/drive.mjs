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
    const before = await page.evaluate(() => ({ plan: slalom.frame.plan.map((p) => [p.x, p.y]), collided: slalom.scalar("collided_share"), bodies: slalom.frame.bodies.length }));
    const pixels = await sceneBytes();
    const [x, y] = await page.evaluate(() => { const c = slalom.scene.camera, p = slalom.frame.plan.at(-1); return c.toScreen(p.x, p.y); });
    const box = await page.locator("#scene").boundingBox();
    await page.mouse.click(box.x + x, box.y + y);
    await h.until((n) => slalom.frame.bodies.length === n + 1, before.bodies);
    await h.send({ do: "step", ticks: 2 });
    await h.until((c) => slalom.scalar("collided_share") > c, before.collided);
    const after = await page.evaluate(() => slalom.frame.plan.map((p) => [p.x, p.y]));
    assert.notDeepEqual(after, before.plan);
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
}
