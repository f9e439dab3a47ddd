// Keyboard, touch, roles, contrast and colour vision.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { coloursByMeaning, similarColours } from "../colour_vision.mjs";

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core"), "utf8");

/** The violations that axe-core finds, in one line each. */
export async function violations(page) {
  // The policy of the page lets no script element be added.
  if (!(await page.evaluate(() => "axe" in globalThis))) await page.evaluate(axe);
  return page.evaluate(async () => {
    const result = await globalThis.axe.run(document, { resultTypes: ["violations"] });
    const line = (v) => v.nodes.map((n) => `${v.id}: ${n.target.join(" ")} ${n.any[0]?.message ?? ""}`);
    return result.violations.flatMap(line);
  });
}

export default async function (h) {
  const { page } = h;

  await h.test("axe-core finds no violation in either theme, with every pane and dialog", async () => {
    await h.pause();
    const found = [];
    const check = async (what) => found.push(...(await violations(page)).map((v) => `${what}: ${v}`));
    for (const theme of ["dark", "light"]) {
      await h.until((name) => document.documentElement.dataset.theme === name, theme);
      for (const pane of ["options", "laps", "charts"]) {
        await h.press("tab-" + pane);
        await check(`${theme}, ${pane}`);
      }
      for (const dialog of ["help", "fork"]) {
        await h.press(dialog);
        await check(`${theme}, ${dialog}`);
        await page.evaluate((id) => document.getElementById(id).close(), dialog + "-box");
      }
      for (const menu of ["save-open", "scenario-open"]) {
        await h.press(menu);
        await check(`${theme}, ${menu}`);
        await h.press(menu);
      }
      await h.press("theme");
    }
    assert.deepEqual([...new Set(found)], []);
  });

  await h.test("keys act only where no control and no dialog has the focus", async () => {
    const press = async (id, key) => {
      await page.focus(id);
      await page.keyboard.press(key);
    };
    const { generation } = await h.state();
    await press('[data-layer="scan"]', "Space");
    assert.equal(await page.isChecked('[data-layer="scan"]'), false, "Space switches the layer");
    assert.equal((await h.state()).paused, true, "and does not continue the drive");
    await press('[data-layer="scan"]', "Space");
    await press("#scene", "?");
    await h.until(() => document.getElementById("help-box").open);
    await page.keyboard.press("r");
    await page.keyboard.press("Escape");
    assert.equal((await h.state()).generation, generation, "R under the help does not restart");
    await press("#scene", "s");
    assert.equal(await page.getAttribute("#save-open", "aria-expanded"), "true");
    await page.keyboard.press("Escape");
    assert.equal(await page.getAttribute("#save-open", "aria-expanded"), "false");
    assert.equal(await page.evaluate(() => document.activeElement.id), "save-open", "the focus returns");
    await press("#tab-charts", "ArrowRight");
    assert.equal(await page.getAttribute("#tab-options", "aria-selected"), "true");
    await page.keyboard.press("Home");
    assert.equal(await page.getAttribute("#tab-charts", "aria-selected"), "true");
  });

  await h.test("a long press deletes an obstacle", async () => {
    const server = await h.start(..."view --course stag --obstacles 4 --seed 3 --port 0".split(" "));
    const look = await h.open(server.address, { hasTouch: true, viewport: { width: 400, height: 800 } });
    const touch = look.page;
    await look.until(() => window.slalom?.frame?.bodies.length > 1 && slalom.state);
    await look.pause();
    await touch.evaluate(() => slalom.stage.fit());
    const tools = await touch.context().newCDPSession(touch);
    const bodies = await touch.evaluate(() => slalom.frame.bodies.length);
    const isDeleted = (n) => slalom.frame.bodies.length === n - 1; // the others are numbered anew
    // Panels that open may move the scene between a look and a touch: then the press is repeated.
    for (let press = 0; press < 5 && !(await touch.evaluate(isDeleted, bodies)); ++press) {
      await look.drawn();
      const body = await touch.evaluate(() => slalom.frame.bodies.find((o) => o.kind !== 0));
      const [x, y] = await look.placeOf(body);
      await tools.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: [{ x, y }] });
      await touch.waitForFunction(isDeleted, bodies, { timeout: 15_000 }).catch(() => undefined);
      await tools.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
    }
    await look.until(isDeleted, bodies);
    await touch.close();
    await server.stop();
  });

  await h.test("the colours of layers differ for every kind of colour vision", async () => {
    assert.deepEqual(await similarColours(), []);
    const [pictures, page] = await coloursByMeaning();
    assert.equal(pictures.length, 9);
    assert.deepEqual(pictures, page, "pictures, videos and page have the same colours");
  });
}
