// The layout at every width: no control outside the window or covered, and a fitted course that no panel covers.
import assert from "node:assert/strict";

const sizes = [[360, 640], [400, 800], [480, 800], [600, 900], [768, 1024], [899, 700], [900, 700], [1024, 768], [1099, 768], [1100, 768], [1280, 720], [1366, 768], [1440, 900], [1699, 900], [1700, 900], [1920, 1080], [2560, 1300]];

/** The controls that are outside the window, covered by something else, or too small for a finger. */
function faults(smallest) {
  const problems = [], name = (e) => `${e.tagName.toLowerCase()}#${e.id || e.dataset.tool || e.dataset.layer || e.dataset.follow || e.textContent.trim().slice(0, 20)}`;
  if (document.documentElement.scrollWidth > innerWidth) problems.push(`the page is ${document.documentElement.scrollWidth} px wide`);
  for (const control of document.querySelectorAll("button, select, input, summary, [role=tab]")) {
    if (!control.checkVisibility({ visibilityProperty: true }) || control.closest("dialog:not([open])")) continue;
    control.scrollIntoView({ block: "nearest", inline: "nearest" });
    const box = control.getBoundingClientRect();
    if (!box.width) continue;
    if (box.left < -0.5 || box.right > innerWidth + 0.5 || box.top < -0.5 || box.bottom > innerHeight + 0.5) problems.push(`${name(control)} is outside: ${[box.left, box.top, box.right, box.bottom].map(Math.round)}`);
    const found = document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2);
    if (!found || !(control.contains(found) || found.contains(control))) problems.push(`${name(control)} is covered by ${found ? name(found) : "nothing"}`);
    const row = control.labels?.[0] ?? control, tall = Math.max(box.height, row.getBoundingClientRect().height);
    if (tall < smallest - 0.5) problems.push(`${name(control)} is ${Math.round(tall)} px high`);
  }
  return problems;
}

/** Panels that lie on the fitted course. */
function covering() {
  slalom.scene.fit();
  slalom.scene.draw();
  const [x0, y0, x1, y1] = slalom.scene.courseBounds, stage = document.getElementById("stage").getBoundingClientRect();
  const [left, bottom] = slalom.scene.camera.toScreen(x0, y0), [right, top] = slalom.scene.camera.toScreen(x1, y1);
  const over = (box) => box.left - stage.left < right && box.right - stage.left > left && box.top - stage.top < bottom && box.bottom - stage.top > top;
  const problems = ["layers", "readout"].filter((id) => over(document.getElementById(id).getBoundingClientRect()));
  if (left < -1 || top < -1 || right > stage.width + 1 || bottom > stage.height + 1) problems.push("the edge of the stage");
  return problems;
}

export default async function (h) {
  const { page } = h;
  const click = (id) => page.evaluate((i) => document.getElementById(i).click(), id);

  await h.test("no control is outside the window or covered at any width, and the fitted course is free", async () => {
    await h.pause();
    if (!h.pictures) await h.hideLayers();
    const found = []; // faults at all widths
    const none = (faults, at) => found.push(...faults.map((fault) => `${at}: ${fault}`));
    const height = () => page.evaluate(() => document.querySelector("header").offsetHeight);
    for (const [width, tall] of sizes) {
      await page.setViewportSize({ width, height: tall });
      await h.drawn();
      const at = `at ${width} x ${tall} px`, smallest = width < 900 ? 44 : 24;
      await page.evaluate((small) => { document.getElementById("layers").open = !small; }, width < 900);
      await h.drawn();
      none((await page.evaluate(covering)).map((what) => `${what} covers the fitted course`), at);
      none(await page.evaluate(faults, smallest), at);
      for (const pane of ["options", "laps", "charts"]) {
        await click("tab-" + pane);
        none(await page.evaluate(faults, smallest), `${pane} ${at}`);
      }
      for (const menu of ["save-open", "scenario-open"]) {
        if (!(await page.isVisible("#" + menu))) continue;
        await click(menu);
        const inside = (button) => [...document.getElementById(button).parentElement.querySelectorAll(".card button, .card select, .card input")].map((e) => e.getBoundingClientRect()).filter((b) => b.left < 0 || b.right > innerWidth || b.bottom > innerHeight).length;
        await page.evaluate(() => scrollTo(0, 0));
        if ((await page.evaluate(inside, menu)) > 0) none([`${menu} opens beyond the window`], at);
        if (menu === "scenario-open") await h.picture(`scenario-${width}`);
        await click(menu);
      }
      await page.evaluate(() => scrollTo(0, 0));
      const paused = await height();
      await page.evaluate(() => { document.getElementById("mode-text").textContent = "lockstep · max speed"; });
      if ((await height()) !== paused) none(["the header changes its height"], at);
      await h.picture(`layout-${width}-dark`);
    }
    await page.setViewportSize({ width: 1280, height: 720 });
    await page.evaluate(() => { document.getElementById("layers").open = true; });
    await h.showLayers();
    assert.deepEqual(found, []);
  });

  await h.test("a long press deletes an obstacle", async () => {
    const touch = await h.open(h.server.address, { hasTouch: true, viewport: { width: 400, height: 800 } });
    await h.until(() => window.slalom?.frame?.bodies.length > 1 && slalom.state, undefined, touch);
    try {
      await touch.evaluate(() => { slalom.send({ do: "pause" }); slalom.scene.fit(); });
      await h.until(() => slalom.state.paused, undefined, touch);
      const bodies = await touch.evaluate(() => slalom.frame.bodies.length), tools = await touch.context().newCDPSession(touch);
      const isDeleted = (n) => slalom.frame.bodies.length === n - 1; // the others are numbered anew
      // Panels that open may move the scene between a look and a touch: then the press is repeated.
      for (let press = 0; press < 5 && !(await touch.evaluate(isDeleted, bodies)); ++press) {
        await h.drawn(touch);
        const body = await touch.evaluate(() => { slalom.scene.draw(); const b = slalom.frame.bodies.find((o) => o.kind !== 0), [x, y] = slalom.scene.camera.toScreen(b.x, b.y), s = document.getElementById("scene").getBoundingClientRect(); return { x: s.x + x, y: s.y + y }; });
        await tools.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: [body] });
        await touch.waitForFunction(isDeleted, bodies, { timeout: 15_000 }).catch(() => {});
        await tools.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
      }
      await h.until(isDeleted, bodies, touch);
      await h.picture("layout-400-touch", touch);
    } finally {
      await touch.close();
    }
  });
}
