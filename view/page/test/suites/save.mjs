// Files that the page saves, and links.
import assert from "node:assert/strict";
import { readFileSync, statSync } from "node:fs";
import { join } from "node:path";
import { patience } from "../harness.mjs";

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
    await h.until(() => slalom.state?.course === "stag" && slalom.scalar("samples") === 777);
    await h.send({ do: "reset_options" });
  });

  /** Saves with a button of the menu; the path of the file. */
  async function saved(id) {
    await page.click("#save-open");
    const [file] = await Promise.all([page.waitForEvent("download", { timeout: patience }), page.click(id)]);
    const path = join(h.folder, file.suggestedFilename());
    await file.saveAs(path);
    return path;
  }

  await h.test("saves a picture", async () => {
    const file = await saved("#save-picture");
    assert.equal(readFileSync(file).subarray(1, 4).toString(), "PNG");
    assert.ok(statSync(file).size > 10000);
  });

  /** Checks that a replay plays, at the speed that is chosen, and can be scrubbed. */
  async function plays(address) {
    const replay = await h.open(address);
    const wait = (what, arg) => h.until(what, arg, replay);
    await wait(() => window.slalom?.replay && slalom.frame && slalom.state.newest > 40);
    const first = await replay.evaluate(() => slalom.state.tick);
    await wait((t) => slalom.state.tick > t, first);
    await replay.click("#play");
    await wait(() => slalom.state.paused);
    await replay.evaluate(() => slalom.send({ do: "seek", tick: 30 }));
    await wait(() => slalom.state.tick === 30);
    const there = await replay.evaluate(() => slalom.scalar("tick"));
    await replay.click("#step");
    await wait((t) => slalom.scalar("tick") === t + 2, there);
    await replay.selectOption("#rate", "4");
    await replay.click("#play");
    await wait(() => slalom.state.tick > 35);
    assert.equal(await replay.isVisible("[data-tool=disc]"), false);
    // Recordings of earlier versions have no symptoms.
    await replay.evaluate(() => {
      delete slalom.hello.symptoms;
      slalom.send({ do: "seek", tick: 20 });
    });
    await wait(() => slalom.state.tick === 20);
    await replay.close();
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
