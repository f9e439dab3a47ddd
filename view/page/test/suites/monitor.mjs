// A controller that runs in another program: the page watches it.
import assert from "node:assert/strict";

export default async function (h) {
  if (!h.monitored) return;
  const server = await h.run(h.monitored, ["0", "3600"]);
  const look = await h.open(server.address);
  const { page } = look;
  await look.until(() => window.slalom?.state && slalom.scalar("tick") > 5);

  await h.test("a running controller is shown with its samples and its options", async () => {
    const shown = await page.evaluate(() => {
      const { candidates, guides, plan, bodies } = slalom.frame;
      return {
        candidates: candidates.count,
        guides: guides.guides,
        plan: plan.length,
        bodies: bodies.length,
      };
    });
    assert.ok(shown.candidates > 50 && shown.guides > 0, JSON.stringify(shown));
    assert.deepEqual([shown.plan, shown.bodies], [41, 5]);
    assert.equal(await page.textContent("#caption"), "robot");
    assert.match(await page.textContent("#label"), /^svg_mppi/);
    const x = await look.scalar("x");
    await look.until((before) => Math.abs(slalom.scalar("x") - before) > 0.5, x);
    await page.click("#tab-options");
    assert.equal(await page.inputValue('[data-key="svg_mppi.samples"] input'), "512");
    await page.click("#tab-charts");
  });

  await h.test("nothing that would change it is there, and what is asked is refused", async () => {
    for (const id of ["restart", "rate", "fork", "method", "ghost", "undo", "reset", "save-replay"])
      assert.equal(await page.isVisible("#" + id), false, id);
    assert.match(await page.textContent("#mode"), /^watching/);
    for (const command of [{ do: "restart" }, { do: "set", key: "svg_mppi.samples", value: "8" }]) {
      const refused = await page.evaluate((c) => slalom.ask(c).catch((error) => error.message), command);
      assert.equal(refused, "this page shows a controller that runs elsewhere; it cannot change it");
    }
    const body = await page.evaluate(() => slalom.frame.bodies[1]);
    await page.mouse.move(...(await look.placeOf(body)), { steps: 3 });
    await look.until(() => document.getElementById("scene").style.cursor === "default");
  });

  await h.test(
    "the page pauses and shows what was planned before, while the controller goes on",
    async () => {
      await page.click("#play");
      await look.isPaused();
      const { newest } = await look.state();
      await look.seek(3);
      assert.match(await page.textContent("#play"), /^Play$/);
      await look.until((tick) => slalom.state.newest > tick + 5, newest);
      assert.equal(await look.scalar("tick"), 3);
      if (process.env.SLALOM_SCREENSHOT) await page.screenshot({ path: process.env.SLALOM_SCREENSHOT });
      await page.click("#play");
      await look.until((tick) => slalom.scalar("tick") > tick, newest);
    },
  );

  await page.close();
  await server.stop();
}
