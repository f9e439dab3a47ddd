// The page that a new user sees: the program without arguments.
import assert from "node:assert/strict";

export default async function (h) {
  await h.until(() => window.slalom?.frame && slalom.state);
  await h.test("without arguments two controllers stand side by side", async () => {
    await h.pause(); // the other page needs the processor too
    const server = await h.start("view", "--port", "0");
    const tab = await h.open(server.address);
    const { page } = tab;
    await tab.until(() => window.slalom?.frame?.ghostFrame && slalom.stage.isSideBySide());
    const shows = (text) => tab.says("introduction-text", text);
    const layers = () =>
      page.locator("#layer-list :checked").evaluateAll((all) => all.map((e) => e.dataset.layer));
    const next = () => page.click("#introduction-next");
    await shows("1 of 6. Samples: ");
    await tab.isPaused();
    assert.equal((await tab.state()).rate, 0.1, "in slow motion");
    const [tick, plan] = await page.evaluate(() => [slalom.scalar("tick"), slalom.frame.plan.length]);
    assert.ok(tick > 0 && plan > 0);
    const explained = ["candidates", "plan", "guides"];
    const first = (await layers()).filter((each) => explained.includes(each));
    assert.deepEqual(first, ["candidates"]);
    for (const text of ["2 of 6. Weights: ", "3 of 6. Plan: ", "4 of 6. Guides: "]) {
      await next();
      await shows(text);
    }
    for (const each of explained) assert.ok((await layers()).includes(each), each);
    assert.equal(await tab.scalar("tick"), tick, "nothing moves until the viewer has read");
    await next();
    await shows("5 of 6. Two ways: left and right of the parked car. mppi gives weight to both");
    await tab.isPaused();
    const texts = await page.locator(".caption").allTextContents();
    assert.match(texts[0], /^svg_mppi commits: /);
    assert.match(texts[1], /^mppi averages: /);
    await next();
    await shows("6 of 6. mppi has hit the parked car");
    await tab.until(() => slalom.state.paused && slalom.introduction.marks.length === 1);
    const [mark, hit] = await page.evaluate(() => [
      slalom.introduction.marks[0],
      slalom.frame.ghostFrame.bodies[0],
    ]);
    assert.ok(mark.isGhost && Math.hypot(mark.x - hit.x, mark.y - hit.y) < 0.1);
    await next();
    await shows("Passed: svg_mppi without a collision, mppi with ");
    await shows("mppi hits 22 % of the cars");
    // Back at the decision, before the collision.
    await page.click("#introduction-drag");
    await tab.until(() => document.getElementById("introduction").hidden && slalom.stage.isSideBySide());
    await tab.until(() => {
      const { scalars } = slalom.frame.ghostFrame;
      return slalom.state.paused && scalars[slalom.hello.scalars.indexOf("contacts")] === 0;
    });
    // Without guides, from the beginning and still side by side.
    await tab.press("introduction-without");
    await tab.until(() => slalom.state.rate === 0.25 && !slalom.state.paused);
    await tab.until(
      () => slalom.scalar("tick") > 5 && slalom.frame.ghostFrame && slalom.stage.isSideBySide(),
    );
    await tab.press("tab-options");
    const option = (key) => page.locator(`[data-key="svg_mppi.${key}"] input`);
    for (const key of ["use_nominal", "adapt_covariance"])
      assert.equal(await option(key).isChecked(), false, key);
    // After a reload the address holds the scenario, and the view is the ordinary one.
    await page.reload();
    await tab.until(() => window.slalom?.frame?.ghostFrame && slalom.state);
    const isOrdinary = () => !slalom.stage.isSideBySide() && document.getElementById("introduction").hidden;
    assert.equal(await page.evaluate(isOrdinary), true);
    await page.click("#split");
    await tab.until(() => slalom.stage.isSideBySide() && !document.getElementById("lane-title").hidden);
    const distance = await page.evaluate(() => {
      const { camera, ghostCamera, placeCameras, placeOf } = slalom.stage;
      placeCameras();
      const { left, top } = document.getElementById("scene").getBoundingClientRect();
      const p = placeOf({ clientX: left + 640, clientY: top + 300 });
      const [there, same] = [ghostCamera.toMap(640, 300), camera.toMap(p.x, p.y)];
      return Math.hypot(there[0] - same[0], there[1] - same[1]);
    });
    assert.ok(distance < 1e-6, "a point of the ghost's lane is the same place in the car's");
    await page.keyboard.press("g");
    await tab.until(() => !slalom.stage.isSideBySide());
    await page.close();
    await server.stop();
    await h.play();
  });
}
