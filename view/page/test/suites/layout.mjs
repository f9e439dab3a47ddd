// The layout at every width: no control is outside the window or covered.
import assert from "node:assert/strict";

const widths = [360, 480, 600, 768, 899, 900, 1023, 1099, 1100, 1280, 1699, 1700, 2560];

/** The controls that are outside the window, covered by something else, or too small for a finger. */
function faults([smallest, within]) {
  const problems = [];
  const name = (e) =>
    `${e.tagName}#${e.id || e.dataset.tool || e.dataset.layer || e.textContent.trim().slice(0, 20)}`;
  const { scrollWidth } = document.documentElement;
  if (scrollWidth > innerWidth) problems.push(`the page is ${scrollWidth} px wide`);
  for (const control of document.querySelector(within).querySelectorAll("button, select, input, summary")) {
    if (!control.checkVisibility({ visibilityProperty: true }) || control.closest("dialog:not([open])"))
      continue;
    control.scrollIntoView({ block: "nearest", inline: "nearest" });
    const { left, right, top, bottom, width, height } = control.getBoundingClientRect();
    if (!width) continue;
    const isInside = left >= -0.5 && right <= innerWidth + 0.5 && top >= -0.5 && bottom <= innerHeight + 0.5;
    if (!isInside)
      problems.push(`${name(control)} is outside: ${[left, top, right, bottom].map(Math.round)}`);
    const found = document.elementFromPoint(left + width / 2, top + height / 2);
    const isFree = found && (control.contains(found) || found.contains(control));
    if (!isFree) problems.push(`${name(control)} is covered by ${found ? name(found) : "nothing"}`);
    const row = control.labels?.[0] ?? control;
    const tall = Math.max(height, row.getBoundingClientRect().height);
    if (tall < smallest - 0.5) problems.push(`${name(control)} is ${Math.round(tall)} px high`);
  }
  scrollTo(0, 0);
  return problems;
}

/** The panels that lie on the fitted course. */
function covering() {
  slalom.stage.fit();
  slalom.scene.drawScene();
  const [x0, y0, x1, y1] = slalom.stage.bounds;
  const stage = document.getElementById("stage").getBoundingClientRect();
  const [left, bottom] = slalom.stage.camera.toScreen(x0, y0);
  const [right, top] = slalom.stage.camera.toScreen(x1, y1);
  const isOver = (id) => {
    const box = document.getElementById(id).getBoundingClientRect();
    const beside = box.left - stage.left >= right || box.right - stage.left <= left;
    return !beside && box.top - stage.top < bottom && box.bottom - stage.top > top;
  };
  const isInside = left >= -1 && top >= -1 && right <= stage.width + 1 && bottom <= stage.height + 1;
  return ["layers", "readout"].filter(isOver).concat(isInside ? [] : ["the edge of the stage"]);
}

export default async function (h) {
  const { page } = h;

  await h.test("no control is outside the window or covered, nor is the fitted course", async () => {
    await h.pause();
    const found = [];
    const check = async (at, smallest, within = "body") =>
      found.push(...(await page.evaluate(faults, [smallest, within])).map((fault) => `${at}: ${fault}`));
    for (const width of widths) {
      const smallest = width < 900 ? 44 : 24;
      await page.setViewportSize({ width, height: width < 900 ? 800 : 720 });
      await page.evaluate((isSmall) => (document.getElementById("layers").open = !isSmall), width < 900);
      await h.drawn();
      const panels = await page.evaluate(covering);
      if (panels.length) found.push(`${width}: ${panels} on the fitted course`);
      for (const pane of ["options", "laps", "charts"]) {
        await h.press("tab-" + pane);
        await check(`${width}, ${pane}`, smallest);
      }
      for (const menu of ["save", "scenario"]) {
        if (!(await page.isVisible(`#${menu}-open`))) continue;
        await h.press(menu + "-open");
        await check(`${width}, ${menu}`, smallest, "#" + menu);
        await h.press(menu + "-open");
      }
    }
    await page.setViewportSize({ width: 1280, height: 720 });
    await page.evaluate(() => (document.getElementById("layers").open = true));
    assert.deepEqual(found, []);
    await h.play();
  });
}
