// Files that the page saves, and links.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";

export default async function (h) {
  const { page } = h;

  await h.test("the address holds the scenario and what was changed", async () => {
    await h.send({ do: "set", key: "svg_mppi.samples", value: "777" });
    await h.until(() => location.hash.includes("set=svg_mppi.samples=777"));
    const address = page.url();
    await h.send({ do: "scenario", course: "eel", seed: "9" });
    await h.until(() => location.hash.includes("course=eel") && !location.hash.includes("777"));
    await page.goto("about:blank");
    await page.goto(address);
    await h.until(() => slalom.state?.course === "stag" && location.hash.includes("777"));
    await h.says("command", "svg_mppi.samples=777");
    await h.send({ do: "reset_options" });
  });

  /** Saves with a button of the menu; the path of the file. */
  async function saved(id) {
    await page.click("#save-open");
    const file = await h.saved(id);
    const path = join(h.folder, file.suggestedFilename());
    await file.saveAs(path);
    return path;
  }

  await h.test("saves a picture of twice the size, with its legend", async () => {
    await h.pause();
    const { width, height } = await page.evaluate(() => slalom.stage.size);
    const png = readFileSync(await saved("#save-png"));
    assert.equal(png.subarray(1, 4).toString(), "PNG");
    assert.equal(png.readUInt32BE(16), 2 * width);
    assert.ok(png.readUInt32BE(20) > 2 * height + 60, "the legend is below the scene");
    await h.play();
  });

  /** Checks that a replay plays, at the speed that is chosen, and can be scrubbed. */
  async function plays(address) {
    const replay = await h.open(address);
    await replay.until(() => window.slalom?.isReplay && slalom.frame && slalom.state.newest > 40);
    const first = (await replay.state()).tick;
    await replay.until((t) => slalom.state.tick > t, first);
    await replay.page.click("#play");
    await replay.until(() => slalom.state.paused);
    await replay.send({ do: "seek", tick: 30 });
    await replay.until(() => slalom.state.tick === 30);
    const there = await replay.scalar("tick");
    await replay.page.click("#step");
    await replay.until((t) => slalom.scalar("tick") === t + 1, there);
    await replay.page.selectOption("#rate", "4");
    await replay.page.click("#play");
    await replay.until(() => slalom.state.tick > 35);
    assert.equal(await replay.page.isVisible("[data-tool=disc]"), false);
    await replay.page.close();
  }

  await h.test("the exported replay opens from disk and plays", async () => {
    await h.until(() => slalom.scalar("tick") > 80);
    await plays("file://" + (await saved("#save-replay")));
  });

  await h.test("a recording saved from the page opens with slalom replay", async () => {
    const file = await saved("#save-recording");
    if (process.env.SLALOM_PAGE) return; // that page has no recording inside
    const shown = await h.start("replay", file, "--port", "0");
    await plays(shown.address);
    await shown.stop();
  });
}
