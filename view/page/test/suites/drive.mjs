// The drive: time, obstacles, options.
import assert from "node:assert/strict";

export default async function (h) {
  const { page } = h;
  /** Drags a slider to a value. */
  const slide = (selector, value) =>
    page.locator(selector).evaluate((slider, to) => {
      slider.value = String(to);
      for (const type of ["input", "change"]) slider.dispatchEvent(new Event(type));
    }, value);

  await h.test("shows a moving labelled car", async () => {
    await h.until(() => window.slalom?.frame && slalom.scalar("speed") > 0.1);
    await h.says("label", "svg_mppi");
    const first = await h.scalar("x");
    await h.until((x) => Math.abs(slalom.scalar("x") - x) > 0.2, first);
  });

  await h.test("pauses, steps one tick, goes back and on again to the same place, bit for bit", async () => {
    await h.until(() => slalom.scalar("tick") > 60);
    await page.click("#play");
    await h.isPaused();
    const tick = await h.scalar("tick");
    await page.click("#step");
    await h.until((t) => slalom.scalar("tick") === t + 1, tick);
    const there = await h.scalar("x");
    await slide("#timeline", tick - 29);
    await h.until((t) => slalom.scalar("tick") === t, tick - 29);
    await h.says("mode-text", "earlier");
    await h.step(30);
    assert.equal(await h.scalar("x"), there);
  });

  await h.test("an obstacle on the plan changes it, and can be dragged and deleted", async () => {
    const newest = (await h.state()).newest;
    if (newest < 122) await h.step(122 - newest);
    await h.seek(120); // here no wall hides the end of the plan from the scanner
    await h.step(2);
    const place = await page.evaluate(() => slalom.frame.plan[Math.round(0.6 * slalom.frame.plan.length)]);
    const nearest = () =>
      page.evaluate(
        (p) => Math.min(...slalom.frame.plan.map((s) => Math.hypot(s.x - p.x, s.y - p.y))),
        place,
      );
    const without = await nearest();
    await h.seek(120);
    const bodies = await page.evaluate(() => slalom.frame.bodies.length);
    await page.mouse.click(...(await h.placeOf(place)));
    await h.until((n) => slalom.frame.bodies.length === n + 1, bodies);
    await h.step(2); // the scan of a control step may be from before the edit
    const body = await page.evaluate(() => slalom.frame.bodies.at(-1));
    const distance = await nearest();
    assert.ok(distance > without + body.length / 2, `the plan leads within ${distance} m of the obstacle`);

    const [x, y] = await h.placeOf(body);
    await h.drag([x, y], [x + 40, y + 10]);
    const isMoved = (b) => Math.abs(slalom.frame.bodies.find((o) => o.id === b.id).x - b.x) > 0.1;
    await h.until(isMoved, body);
    const moved = await page.evaluate((id) => slalom.frame.bodies.find((o) => o.id === id), body.id);
    await page.mouse.click(...(await h.placeOf(moved)), { button: "right" });
    await h.until((id) => !slalom.frame.bodies.some((o) => o.id === id), body.id);
  });

  await h.test("Play and Pause answer before the server does", async () => {
    const words = () => page.textContent("#play span");
    for (const [before, after] of [
      ["Play", "Pause"],
      ["Pause", "Play"],
    ]) {
      assert.equal(await words(), before);
      await h.press("play");
      assert.equal(await words(), after);
    }
    await h.pause();
  });

  await h.test("keys undo and redo a change of obstacles", async () => {
    const count = await page.evaluate(() => slalom.frame.bodies.length);
    const [x, y] = [(await h.scalar("x")) + 3, await h.scalar("y")];
    await h.send({ do: "add", kind: "box", x, y, yaw: 0.3, length: 0.4, width: 0.4 });
    const shows = (wanted) => h.until((n) => slalom.frame.bodies.length === n, wanted);
    await shows(count + 1);
    await page.focus("#scene");
    for (const [key, shown] of [
      ["z", count],
      ["y", count + 1],
      ["z", count],
    ]) {
      await page.keyboard.press("Control+" + key);
      await shows(shown);
    }
  });

  await h.test("a slider changes the option in the solver, and undo takes it back", async () => {
    await h.play();
    const before = await h.scalar("samples");
    await page.click("#tab-options");
    await slide('[data-key="svg_mppi.samples"] input[type=range]', 0.4);
    await h.until((n) => slalom.scalar("samples") !== n, before);
    await h.says("command", "--set 'svg_mppi.samples=");
    await page.click("#undo");
    await h.until((n) => slalom.scalar("samples") === n, before);
    await h.send({ do: "set", key: "svg_mppi.samples", value: "0" });
    await h.says("toast", "must be in");
    await page.click("#tab-charts");
  });

  await h.test("says why plans are poor", async () => {
    await h.send({ do: "set", key: "svg_mppi.variance", value: "[1e-9, 1e-9]" });
    await h.says("label", "small variance");
    assert.match(await page.getAttribute("#label", "title"), /standard deviation/);
    await h.send({ do: "undo" });
    await h.until(() => !document.getElementById("label").textContent.includes("small variance"));
  });

  await h.test("opponents drive along the line", async () => {
    await h.send({ do: "scenario", opponents: 2 });
    await h.until(() => slalom.frame.bodies.filter((b) => b.kind === 4).length === 2);
    const first = await page.evaluate(() => slalom.frame.bodies.find((b) => b.kind === 4).x);
    await h.until((x) => Math.abs(slalom.frame.bodies.find((b) => b.kind === 4).x - x) > 0.3, first);
    await h.send({ do: "scenario", opponents: 0 });
    await h.until(() => slalom.state.opponents === 0 && slalom.scalar("tick") > 3);
  });
}
