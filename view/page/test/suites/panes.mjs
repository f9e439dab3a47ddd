// The panes and what the page knows of the past.
import assert from "node:assert/strict";

export default async function (h) {
  const { page } = h;
  /** Whether a page knows every stored step. */
  const isWhole = () =>
    window.slalom?.state &&
    slalom.frame &&
    !slalom.past.missing(Math.max(0, slalom.state.oldest), slalom.state.newest, 1);

  await h.test("the scalars of steps without a frame arrive late instead of never", async () => {
    await h.pause();
    await h.step(120); // few frames of 120 steps in one go can be sent
    await h.until(isWhole);
    const tick = (await h.state()).newest - 60;
    const late = await page.evaluate((t) => [...slalom.past.at(t)], tick);
    await h.seek(tick);
    assert.deepEqual(late, await page.evaluate(() => [...slalom.frame.scalars]));
  });

  await h.test("a page that is opened later knows the minute before", async () => {
    const other = await h.open(page.url());
    await other.until(isWhole);
    await other.drawn();
    const [points, steps] = await other.page.evaluate(() => {
      const { oldest } = slalom.state;
      return [slalom.past.line().length / 2, slalom.scalar("tick") - Math.max(0, oldest) + 1];
    });
    assert.ok(points > 0.9 * steps, `${points} points of ${steps} steps`);
    await other.page.close();
  });

  await h.test("one cursor shows the same time in charts, scene and slider; a click goes there", async () => {
    await h.seek((await h.state()).newest);
    await h.drawn();
    const chart = page.locator("#charts .u-over").first();
    await chart.scrollIntoViewIfNeeded();
    const over = await chart.boundingBox();
    const place = [over.x + 0.5 * over.width, over.y + 20];
    await page.mouse.move(...place);
    await h.until(() => slalom.cursor !== undefined);
    const [at, speed] = await page.evaluate(() => {
      const { cursor } = slalom;
      return [cursor, slalom.scalar("speed", slalom.past.at(cursor))];
    });
    assert.ok(at > 0 && at < (await h.state()).newest);
    const isShown = (text) =>
      [...document.querySelectorAll("#charts .value")].some((e) => e.textContent === text);
    await h.until(isShown, `car ${speed.toFixed(2)}`);
    assert.equal(await page.isVisible("#timeline-mark"), true);
    await page.mouse.click(...place);
    await h.until((t) => slalom.state.paused && slalom.scalar("tick") === t, at);
    await page.mouse.move(5, 5);
    await h.until(() => slalom.cursor === undefined);
  });

  await h.test("a chart says what it shows where its title does not", async () => {
    const plain = await page.locator("#charts h2:not([title*=' '])").allTextContents();
    assert.deepEqual(
      plain.map((text) => text.split(",")[0]),
      ["Steering", "Speed"],
    );
  });

  await h.test("the charts are saved as CSV", async () => {
    await h.until(isWhole);
    const [head, ...cells] = await h.csv();
    assert.deepEqual(head.slice(0, 3), ["tick", "time [s]", "distance_cost"]);
    assert.ok(cells.length > 10 && cells.every((row) => row.length === head.length));
    const known = (t) => slalom.past.at(t)[slalom.hello.scalars.indexOf("speed")];
    const speed = await page.evaluate(known, Number(cells[5][0]));
    assert.equal(Number(cells[5][head.indexOf("speed [m/s]")]), speed);
  });

  await h.test("a short list of options comes first, and the search finds the others", async () => {
    await page.click("#tab-options");
    const keys = () =>
      page.locator("#option-list [data-key]").evaluateAll((all) => all.map((e) => e.dataset.key));
    const first = await keys();
    assert.ok(first.length <= 12 && first.includes("svg_mppi.samples"), `${first}`);
    await page.fill("#filter", "steer_limit");
    assert.deepEqual(await keys(), ["planner.steer_limit"]);
    await page.fill("#filter", "");
    await page.click("#all-options");
    assert.ok((await keys()).length > 60);
    await page.click("#all-options");
    await page.click("#tab-charts");
  });

  await h.test("a field keeps what was typed while it is not valid", async () => {
    const isMarked = (value) => document.getElementById("obstacles").ariaInvalid === value;
    await page.click("#scenario-open");
    const { obstacles } = await h.state();
    for (const value of ["99", String(obstacles)]) {
      await page.fill("#obstacles", value);
      await page.keyboard.press("Enter");
      await h.until(isMarked, String(value === "99"));
      assert.equal(await page.inputValue("#obstacles"), value);
    }
    await page.keyboard.press("Escape");
  });
}
