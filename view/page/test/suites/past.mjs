// Nothing is lost: steps without a frame, a reload, undo of obstacles, what was typed, a new server.
import assert from "node:assert/strict";

export default async function (h) {
  const { page } = h;
  /** The page knows every stored step, which are those that it can show again. */
  const known = () => window.slalom?.state && slalom.frame && !slalom.past.missing(Math.max(0, slalom.state.oldest), slalom.state.newest, 1);

  await h.test("the scalars of steps without a frame arrive late instead of never", async () => {
    await h.pause();
    const before = (await h.state()).newest;
    await h.send({ do: "step", ticks: 120 }); // of 120 steps in one go, few frames can be sent
    await h.until((n) => slalom.state.newest >= n && slalom.state.tick === slalom.scalar("tick"), before + 120);
    await h.until(known);
    const names = await page.evaluate(() => slalom.hello.scalars), tick = (await h.state()).newest - 60;
    const late = await page.evaluate((t) => [...slalom.past.at(t)], tick);
    await h.send({ do: "seek", tick });
    await h.until((t) => slalom.scalar("tick") === t, tick);
    const shown = await page.evaluate(() => [...slalom.frame.scalars]);
    assert.deepEqual(late, shown, `the same as in the frame: ${names}`);
  });

  await h.test("a reloaded page has the charts and the driven line of the minute before", async () => {
    const other = await h.open(page.url());
    await h.until(known, undefined, other);
    await h.drawn(other);
    const { points, steps } = await other.evaluate(() => { slalom.scene.draw(); return { points: slalom.scene.driven.length / 2, steps: slalom.scalar("tick") - Math.max(0, slalom.state.oldest) + 1 }; });
    assert.ok(points > 0.9 * steps, `${points} points of ${steps} steps`);
    await other.close();
  });

  await h.test("one cursor shows the same time in charts, scene and slider, and the values there", async () => {
    await h.send({ do: "seek", tick: (await h.state()).newest });
    await h.until(() => slalom.scalar("tick") === slalom.state.newest);
    await h.drawn();
    const over = await page.locator("#charts .u-over").first().boundingBox();
    await page.mouse.move(over.x + 0.5 * over.width, over.y + 20);
    await h.until(() => slalom.scene.probe);
    const at = await page.evaluate(() => { const p = slalom.scene.probe; let i = slalom.state.newest; while (i >= 0 && slalom.past.at(i)?.[slalom.hello.scalars.indexOf("x")] !== p.x) --i; return i; });
    assert.ok(at > 0 && at < (await h.state()).newest);
    const speed = await page.evaluate((i) => slalom.past.at(i)[slalom.hello.scalars.indexOf("speed")], at);
    await h.until((text) => [...document.querySelectorAll("#charts h2 em")].some((e) => e.textContent === text), `car ${speed.toFixed(2)}`);
    const lefts = await page.evaluate(() => [...document.querySelectorAll("#charts .chart:not([hidden]) .u-cursor-x")].filter((l) => l.closest(".chart").querySelectorAll(".u-axis").length < 3).map((l) => Math.round(new DOMMatrix(getComputedStyle(l).transform).m41)));
    const shown = lefts.filter((x) => x > 0);
    assert.ok(shown.length > 0 && Math.max(...shown) - Math.min(...shown) <= 1, `the cursors stand at ${lefts} px; at most the rounding of one pixel may separate them`);
    assert.equal(await page.isVisible("#timeline-mark"), true);
    await h.picture("cursor");
    await page.mouse.click(over.x + 0.5 * over.width, over.y + 20);
    await h.until((t) => slalom.state.paused && slalom.scalar("tick") === t, at);
    await page.mouse.move(5, 5);
    await h.until(() => !slalom.scene.probe);
  });

  await h.test("undo and redo cover obstacles", async () => {
    const bodies = () => page.evaluate(() => JSON.stringify(slalom.frame.bodies.slice(1).map((b) => [b.kind, b.x, b.y])));
    const shows = (wanted) => h.until((text) => JSON.stringify(slalom.frame.bodies.slice(1).map((b) => [b.kind, b.x, b.y])) === text, wanted);
    const empty = await bodies();
    const [x, y] = await page.evaluate(() => [slalom.scalar("x") + 3, slalom.scalar("y")]);
    await h.send({ do: "add", kind: "box", x, y, yaw: 0.3, length: 0.4, width: 0.4 });
    await h.until((text) => JSON.stringify(slalom.frame.bodies.slice(1).map((b) => [b.kind, b.x, b.y])) !== text, empty);
    const added = await bodies(), id = await page.evaluate(() => slalom.frame.bodies.at(-1).id);
    for (const dx of [0.1, 0.2, 0.3]) await h.send({ do: "move", body: id, x: x + dx, y, yaw: 0.3, drag: 7 });
    await h.until(([i, to]) => Math.abs(slalom.frame.bodies.find((b) => b.id === i).x - to) < 1e-4, [id, x + 0.3]);
    const moved = await bodies();
    await h.send({ do: "remove", body: id });
    await shows(empty);
    await page.focus("#scene");
    await page.keyboard.press("Control+z");
    await shows(moved);
    await page.keyboard.press("Control+z");
    await shows(added); // the three steps of the drag are one change
    await page.keyboard.press("Control+z");
    await shows(empty);
    await page.keyboard.press("Control+y");
    await shows(added);
    await page.keyboard.press("Control+z");
    await shows(empty);
  });

  await h.test("a dialog keeps what was typed when its command fails", async () => {
    await page.click("#fork");
    await page.fill("#fork-options", "samples=-5");
    await page.click("#fork-go");
    await h.until(() => /samples/.test(document.getElementById("fork-error").textContent) && !document.getElementById("fork-error").hidden);
    assert.equal(await page.inputValue("#fork-options"), "samples=-5");
    await page.keyboard.press("Escape");
    await h.until(() => !document.getElementById("fork-box").open);
    if (await page.isVisible("#scenario-open")) await page.click("#scenario-open");
    await page.fill("#obstacles", "99");
    await page.keyboard.press("Enter");
    await h.until(() => document.getElementById("obstacles").ariaInvalid === "true");
    assert.equal(await page.inputValue("#obstacles"), "99");
    await page.fill("#obstacles", String((await h.state()).obstacles));
    await page.keyboard.press("Enter");
    await h.until(() => document.getElementById("obstacles").ariaInvalid === "false");
    await page.keyboard.press("Escape");
  });

  await h.test("the charts are saved as CSV", async () => {
    await h.until(() => slalom.frame && slalom.scalar("tick") > 20);
    await h.pause();
    await h.until(() => !slalom.past.missing(slalom.past.oldest, slalom.past.newest, 1)); // the cells of a step are empty until they arrive
    const [file] = await Promise.all([page.waitForEvent("download"), page.click("#csv")]);
    const { readFileSync } = await import("node:fs"), rows = readFileSync(await file.path(), "utf8").trim().split("\n").map((row) => row.split(","));
    assert.deepEqual(rows[0].slice(0, 3), ["tick", "time", "distance_cost"]);
    assert.ok(rows.length > 10 && rows.every((row) => row.length === rows[0].length));
    const speed = rows[0].indexOf("speed"), known = await page.evaluate((t) => slalom.past.at(t)[slalom.hello.scalars.indexOf("speed")], Number(rows[5][0]));
    assert.equal(Number(rows[5][speed]), known);
  });

  await h.test("a short list of options comes first, and the search finds the others", async () => {
    await page.click("#tab-options");
    const keys = () => page.evaluate(() => [...document.querySelectorAll("#option-list [data-key]")].map((e) => e.dataset.key));
    const first = await keys();
    assert.ok(first.length <= 12 && first.includes("svg_mppi.samples") && !first.includes("planner.steer_limit"), `${first}`);
    await page.fill("#filter", "steer_limit");
    assert.deepEqual(await keys(), ["planner.steer_limit"]);
    await page.fill("#filter", "");
    await page.click("#all-options");
    assert.ok((await keys()).length > 60);
    await page.click("#all-options");
    assert.equal((await keys()).length, first.length);
  });

  await h.test("presets are saved and loaded as YAML, and a mistake keeps what was typed", async () => {
    await h.send({ do: "set", key: "svg_mppi.temperature", value: "5" });
    await h.until(() => document.querySelector('[data-key="svg_mppi.temperature"]').classList.contains("changed"));
    const { readFileSync } = await import("node:fs");
    const [file] = await Promise.all([page.waitForEvent("download"), page.click("#save-preset")]);
    const yaml = readFileSync(await file.path(), "utf8");
    assert.equal(yaml, "base: default\nsvg_mppi:\n  temperature: 5\n");
    await h.send({ do: "reset_options" });
    await page.click("#load-preset");
    const load = async (text) => { await page.fill("#preset-text", text); await page.click("#preset-go"); };
    await load("svg_mppi:\ntemperature: 5\n");
    await h.until(() => /^Line 2: /.test(document.getElementById("preset-error").textContent));
    await load("svg_mppi:\n  temperatur: 5\n");
    await h.until(() => /temperature/.test(document.getElementById("preset-error").textContent));
    assert.equal(await page.inputValue("#preset-text"), "svg_mppi:\n  temperatur: 5\n");
    await load(yaml);
    await h.until(() => !document.getElementById("preset-box").open && document.querySelector('[data-key="svg_mppi.temperature"] input').value === "5");
    await h.send({ do: "undo" });
    await h.until(() => !document.querySelector('[data-key="svg_mppi.temperature"]').classList.contains("changed"));
    await page.click("#tab-charts");
  });
}
