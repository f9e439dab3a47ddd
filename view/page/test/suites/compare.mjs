// Two controllers: forks and ghosts.
import assert from "node:assert/strict";

export default async function (h) {
  const { page } = h;

  /** Pauses and shows the state some ticks before the newest. */
  async function goBack(ticks) {
    await h.pause();
    const tick = (await h.state()).newest - ticks;
    await h.send({ do: "seek", tick });
    await h.until((t) => slalom.state.tick === t && slalom.scalar("tick") === t, tick);
  }

  await h.test("forks from an earlier tick with the other method and keeps this one as a ghost", async () => {
    await h.restart();
    await h.until(() => slalom.state.newest > 25);
    await goBack(20);
    await page.click("#fork");
    await page.selectOption("#fork-method", "mppi");
    await page.click("#fork-go");
    await h.until(() => slalom.state.ghost === "svg_mppi" && slalom.state.method === "mppi");
    await page.click("#play");
    await h.until(() => slalom.frame.ghost && Math.hypot(slalom.frame.ghost.x - slalom.scalar("x"), slalom.frame.ghost.y - slalom.scalar("y")) > 0.02);
    await h.picture("ghost");
    await h.send({ do: "ghost", method: "" });
    await h.until(() => !slalom.frame.ghost);
  });

  await h.test("forks with other options of the same method", async () => {
    await h.send({ do: "method", method: "svg_mppi" });
    await h.until(() => slalom.state.method === "svg_mppi" && slalom.scalar("tick") > 25);
    await goBack(20);
    await page.keyboard.press("k");
    await page.selectOption("#fork-method", "svg_mppi");
    await page.fill("#fork-options", "samples=640");
    await page.click("#fork-go");
    await h.until(() => slalom.state.ghost_label === "svg_mppi as before");
    await page.click("#play");
    await h.until(() => slalom.scalar("samples") === 640 && /as before/.test(document.getElementById("ghost-label").textContent));
    await h.send({ do: "undo" });
    await h.send({ do: "ghost", method: "" });
    await h.until(() => !slalom.frame.ghost);
  });

  await h.test("a ghost on the same seed starts beside the car", async () => {
    await h.send({ do: "ghost", method: "mppi" });
    const generation = (await h.state()).generation;
    await page.click("#restart");
    await h.until((g) => slalom.state.generation > g && slalom.state.newest > 40 && slalom.frame.ghost && Math.hypot(slalom.frame.ghost.x - slalom.scalar("x"), slalom.frame.ghost.y - slalom.scalar("y")) > 0.005, generation);
    await h.pause();
    await h.send({ do: "seek", tick: 40 });
    await h.until(() => slalom.scalar("tick") === 40);
    assert.ok(Math.abs(await page.evaluate(() => slalom.frame.ghost.laps - slalom.scalar("lap") - slalom.scalar("progress"))) < 0.1);
    await h.send({ do: "ghost", method: "" });
    await h.until(() => slalom.state.ghost === "");
    await h.send({ do: "play" });
  });
}
