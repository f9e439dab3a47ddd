// What the page saves, and links.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
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
    await h.until(() => slalom.state.course === "eel" && location.hash.includes("course=eel") && !location.hash.includes("777"));
    const other = await h.open(address);
    await h.until(() => slalom.state?.course === "stag" && slalom.scalar("samples") === 777, undefined, other);
    await other.close();
    await h.send({ do: "reset_options" });
  });

  /** What the page saves when something is clicked. */
  async function saved(from, id) {
    await from.click("#save-open");
    const [file] = await Promise.all([from.waitForEvent("download", { timeout: patience }), from.click(id)]);
    const path = join(h.folder, file.suggestedFilename());
    await file.saveAs(path);
    return path;
  }

  await h.test("saves a picture", async () => {
    const file = await saved(page, "#save-picture");
    assert.equal(readFileSync(file).subarray(1, 4).toString(), "PNG");
    assert.ok(statSync(file).size > 10000);
  });

  /** A replay that is open: it plays, at the speed that was chosen, and can be scrubbed. */
  async function plays(replay) {
    const wait = (what, arg) => h.until(what, arg, replay);
    await wait(() => window.slalom?.replay && slalom.frame && slalom.state.newest > 40 && document.getElementById("label").textContent.includes("svg_mppi"));
    const first = await replay.evaluate(() => slalom.state.tick);
    await wait((t) => slalom.state.tick > t, first);
    await replay.click("#play");
    await wait(() => slalom.state.paused);
    await replay.evaluate(() => { const t = document.getElementById("timeline"); t.value = "30"; t.dispatchEvent(new Event("input")); t.dispatchEvent(new Event("change")); });
    await wait(() => slalom.state.tick === 30);
    const there = await replay.evaluate(() => slalom.scalar("tick"));
    await replay.click("#step");
    await wait((t) => slalom.scalar("tick") === t + 1, there);
    assert.deepEqual(await replay.evaluate(() => [...document.getElementById("rate").options].map((o) => Number(o.value))), [0.1, 0.25, 0.5, 1, 2, 4]);
    await replay.selectOption("#rate", "4");
    await replay.click("#play");
    await wait(() => slalom.state.tick > 35);
    assert.equal(await replay.isVisible("[data-tool=disc]"), false);
  }

  await h.test("the exported replay opens from disk and plays", async () => {
    await h.until(() => slalom.scalar("tick") > 80);
    const file = await saved(page, "#save-replay");
    const replay = await h.open("file://" + file);
    await plays(replay);
    await h.picture("replay", replay);
    await replay.close();
  });

  await h.test("a recording saved from the page opens with slalom replay", async () => {
    const file = await saved(page, "#save-recording");
    const shown = await h.start("replay", file, "--port", "0"), replay = await h.open(shown.address);
    await plays(replay);
    await replay.close();
    await shown.stop();
  });

  await h.test("a recording of slalom drive becomes a page", async () => {
    const file = join(h.folder, "lap.mcap"), html = join(h.folder, "lap.html");
    execFileSync(h.program, ["drive", "--course", "wren", "--seed", "2", "--obstacles", "3", "--record", file], { stdio: "ignore" });
    execFileSync(h.program, ["replay", file, "--html", html], { stdio: "ignore" });
    const replay = await h.open("file://" + html);
    await plays(replay);
    await replay.close();
  });
}
