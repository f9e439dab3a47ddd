// Keyboard, roles, contrast and colour vision.
import { readFileSync } from "node:fs";
import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { similarColours } from "../colour_vision.mjs";

const axe = createRequire(import.meta.url).resolve("axe-core");

/** What axe-core finds wrong, in one line each. */
async function violations(page) {
  await page.evaluate(readFileSync(axe, "utf8")); // the page's policy lets no script be added
  return page.evaluate(async () => {
    const result = await globalThis.axe.run(document, { resultTypes: ["violations"] });
    return result.violations.flatMap((v) => v.nodes.map((n) => `${v.id}: ${n.target.join(" ")} ${n.any[0]?.message ?? ""}`));
  });
}

export default async function (h) {
  const { page } = h;
  const press = async (id, key) => { await page.focus(id); await page.keyboard.press(key); };

  await h.test("axe-core finds no violation in either theme, with every pane and dialog", async () => {
    await h.pause();
    await h.hideLayers();
    const found = [];
    for (const theme of ["dark", "light"]) {
      await page.evaluate((name) => { if (document.documentElement.dataset.theme !== name) document.getElementById("theme").click(); }, theme);
      for (const pane of ["charts", "options", "laps"]) {
        await page.evaluate((name) => document.getElementById("tab-" + name).click(), pane);
        found.push(...(await violations(page)).map((v) => `${theme}, ${pane}: ${v}`));
      }
      for (const [opens, closes] of [["help", "help-box"], ["fork", "fork-box"]]) {
        await page.evaluate((id) => document.getElementById(id).click(), opens);
        found.push(...(await violations(page)).map((v) => `${theme}, ${opens}: ${v}`));
        await page.evaluate((id) => document.getElementById(id).close(), closes);
      }
      for (const menu of ["save-open", "scenario-open"]) {
        await page.evaluate((id) => document.getElementById(id).click(), menu);
        found.push(...(await violations(page)).map((v) => `${theme}, ${menu}: ${v}`));
        await page.evaluate((id) => document.getElementById(id).click(), menu);
      }
    }
    await page.evaluate(() => { if (document.documentElement.dataset.theme !== "dark") document.getElementById("theme").click(); document.getElementById("tab-charts").click(); });
    await h.showLayers();
    assert.deepEqual([...new Set(found)], []);
  });

  await h.test("keys act only where no control and no dialog has the focus", async () => {
    const generation = (await h.state()).generation;
    await press('[data-layer="scan"]', "Space");
    assert.equal(await page.isChecked('[data-layer="scan"]'), false, "Space switches the layer");
    assert.equal((await h.state()).paused, true, "and does not continue the drive");
    await press('[data-layer="scan"]', "Space");
    await page.focus("#scene");
    await page.keyboard.press("?");
    await page.keyboard.press("r");
    await page.keyboard.press("Escape");
    assert.equal((await h.state()).generation, generation, "R under the help does not restart");
    await page.focus("#scene");
    await page.keyboard.press("s");
    assert.equal(await page.getAttribute("#save-open", "aria-expanded"), "true");
    await page.keyboard.press("Escape");
    assert.equal(await page.getAttribute("#save-open", "aria-expanded"), "false");
    assert.equal(await page.evaluate(() => document.activeElement.id), "save-open", "Escape closes the menu and returns the focus");
    await press("#tab-charts", "ArrowRight");
    assert.equal(await page.getAttribute("#tab-options", "aria-selected"), "true");
    await page.keyboard.press("Home");
    assert.equal(await page.getAttribute("#tab-charts", "aria-selected"), "true");
  });

  await h.test("the colours of layers differ for every kind of colour vision", async () => {
    assert.deepEqual(await similarColours(), []);
  });
}
