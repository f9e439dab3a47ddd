// What a new user sees: the program without arguments.
import assert from "node:assert/strict";

export default async function (h) {
  await h.until(() => window.slalom?.frame && slalom.state);
  await h.test("without arguments two controllers stand side by side, captions follow from the data, and the drive goes on", async () => {
    await h.pause(); // the other page needs the processor too
    const server = await h.start("view", "--port", "0"), page = await h.open(server.address);
    try {
      const text = (id) => page.evaluate((i) => (document.getElementById(i).hidden ? "" : document.getElementById(i).textContent), id);
      const tick = () => page.evaluate(() => slalom.scalar("tick"));
      const step = async (ticks) => { const from = await tick(); await page.evaluate((n) => slalom.send({ do: "step", ticks: n }), ticks); await h.until((t) => slalom.scalar("tick") === t, from + ticks, page); };
      await h.until(() => window.slalom?.frame?.ghostFrame && slalom.scene.isSideBySide, undefined, page);
      await page.evaluate(() => { slalom.send({ do: "restart" }); slalom.send({ do: "pause" }); });
      await h.until(() => slalom.state.paused, undefined, page);
      // The drive may have taken no step before it was paused, or a few.
      await page.evaluate(() => slalom.send(slalom.state.newest < 0 ? { do: "step" } : { do: "seek", tick: 0 }));
      await h.until(() => slalom.state.tick === 0 && slalom.scalar("tick") === 0, undefined, page);
      assert.match(await text("introduction-text"), /svg_mppi and mppi drive/);
      const shown = await page.evaluate(() => { const all = [...slalom.scene.visible]; slalom.scene.visible.clear(); slalom.scene.visible.add("modes"); return all; }); // the rest is slow to draw without a graphics card
      await step(30);
      // Each caption, for as long as it can be seen; what it says is in the weights and plans of the frame.
      const said = { modes: { averages: 0, commits: 0 }, "ghost-modes": { averages: 0, commits: 0 } };
      // The drive differs between compilers, by rounding: svg_mppi may average for a moment.
      const isTold = () => said["ghost-modes"].averages > 0 && said.modes.commits > 2 * said.modes.averages + 2;
      for (let i = 0; i < 40 && !isTold(); ++i) {
        await step(1);
        for (const [id, verdicts] of Object.entries(said)) {
          const says = (await text(id)).match(/^(svg_mppi|mppi) (averages|commits):/);
          if (says) { assert.equal(says[1], id === "modes" ? "svg_mppi" : "mppi"); verdicts[says[2]] += 1; }
        }
      }
      assert.ok(isTold(), `svg_mppi commits, mppi averages before it does: ${JSON.stringify(said)}`);
      assert.equal(await page.evaluate(() => slalom.state.rate), 0.1, "in slow motion");
      await page.evaluate((all) => all.forEach((layer) => slalom.scene.visible.add(layer)), shown);
      await h.drawn(page);
      await h.picture("introduction", page);
      await page.click("#play");
      await h.until(() => slalom.state.rate === 1 && slalom.scalar("tick") > 160 && /^Passed: svg_mppi/.test(document.getElementById("introduction-text").textContent), undefined, page);
      const laps = await page.evaluate(() => [slalom.scalar("lap") + slalom.scalar("progress"), slalom.frame.ghost.laps]);
      await h.until(([car, ghost]) => slalom.scalar("lap") + slalom.scalar("progress") > car + 0.05 && slalom.frame.ghost.laps > ghost + 0.05, laps, page);
      await h.picture("introduction-over", page);
      // After a reload the address holds the scenario, and the view is the ordinary one.
      await page.reload();
      await h.until(() => window.slalom?.frame?.ghost && slalom.state, undefined, page);
      assert.equal(await page.evaluate(() => slalom.scene.isSideBySide || !document.getElementById("introduction").hidden), false);
      // Car and ghost side by side at any time, and back.
      const [x, y] = [640, 300];
      await page.click("#split");
      await h.until(() => slalom.scene.isSideBySide && !document.getElementById("lane-title").hidden, undefined, page);
      const lanes = await page.evaluate(([px, py]) => { slalom.scene.draw(); const s = slalom.scene, p = s.fromGhostLane({ x: px, y: py }); return { there: s.ghostCamera.toMap(px, py), same: s.camera.toMap(p.x, p.y) }; }, [x, y]);
      assert.ok(Math.hypot(lanes.there[0] - lanes.same[0], lanes.there[1] - lanes.same[1]) < 1e-6, "a point of the ghost's lane is the same place in the car's");
      await page.keyboard.press("g");
      await h.until(() => !slalom.scene.isSideBySide, undefined, page);
    } finally {
      await page.close();
      await server.stop();
      await h.send({ do: "play" });
    }
  });
}
