// The page that a new user sees: the program without arguments.
import assert from "node:assert/strict";

export default async function (h) {
  await h.until(() => window.slalom?.frame && slalom.state);
  await h.test("without arguments two controllers stand side by side", async () => {
    await h.pause(); // the other page needs the processor too
    const server = await h.start("view", "--port", "0");
    const page = await h.open(server.address);
    const wait = (what, arg) => h.until(what, arg, page);
    await wait(() => window.slalom?.frame?.ghostFrame && slalom.scene.isSideBySide);
    await page.evaluate(() => ["restart", "pause"].forEach((each) => slalom.send({ do: each })));
    await wait(() => slalom.state.paused);
    // The drive may have taken no step before it was paused, or a few.
    await page.evaluate(() =>
      slalom.send(slalom.state.newest < 0 ? { do: "step" } : { do: "seek", tick: 0 }),
    );
    await wait(() => slalom.state.tick === 0 && slalom.scalar("tick") === 0);
    await wait(() =>
      /svg_mppi and mppi drive/.test(document.getElementById("introduction-text").textContent),
    );
    await page.evaluate(() => slalom.scene.visible.add("modes"));
    await h.step(30, page);
    // The drive differs between compilers, by rounding: svg_mppi may average for a moment.
    const said = { modes: { averages: 0, commits: 0 }, "ghost-modes": { averages: 0, commits: 0 } };
    const isTold = () => said["ghost-modes"].averages > 0 && said.modes.commits > 2 * said.modes.averages + 2;
    for (let i = 0; i < 40 && !isTold(); ++i) {
      await h.step(1, page);
      for (const [id, verdicts] of Object.entries(said)) {
        const text = await page.evaluate((i) => document.getElementById(i).textContent, id);
        const [, method, what] = text.match(/^(svg_mppi|mppi) (averages|commits):/) ?? [];
        if (!what) continue;
        assert.equal(method, id === "modes" ? "svg_mppi" : "mppi");
        verdicts[what] += 1;
      }
    }
    assert.ok(isTold(), `svg_mppi commits, mppi averages before it does: ${JSON.stringify(said)}`);
    assert.equal((await h.state(page)).rate, 0.1, "in slow motion");
    await h.drawn(page);
    await page.click("#play");
    await wait(() => slalom.state.rate === 1 && slalom.scalar("tick") > 160);
    await wait(() => /^Passed: svg_mppi/.test(document.getElementById("introduction-text").textContent));
    // After a reload the address holds the scenario, and the view is the ordinary one.
    await page.reload();
    await wait(() => window.slalom?.frame?.ghost && slalom.state);
    const isOrdinary = () => !slalom.scene.isSideBySide && document.getElementById("introduction").hidden;
    assert.equal(await page.evaluate(isOrdinary), true);
    await page.click("#split");
    await wait(() => slalom.scene.isSideBySide && !document.getElementById("lane-title").hidden);
    const distance = await page.evaluate(() => {
      slalom.scene.draw();
      const { camera, stage } = slalom.scene;
      const p = stage.fromGhostLane({ x: 640, y: 300 });
      const [there, same] = [stage.ghostCamera.toMap(640, 300), camera.toMap(p.x, p.y)];
      return Math.hypot(there[0] - same[0], there[1] - same[1]);
    });
    assert.ok(distance < 1e-6, "a point of the ghost's lane is the same place in the car's");
    await page.keyboard.press("g");
    await wait(() => !slalom.scene.isSideBySide);
    await page.close();
    await server.stop();
    await h.play();
  });
}
