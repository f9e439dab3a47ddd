// Two controllers: forks and ghosts.
import assert from "node:assert/strict";

export default async function (h) {
  const { page } = h;
  /** Whether the ghost is somewhere else than the car. */
  const isApart = () => {
    const { bodies, ghostFrame } = slalom.frame;
    const ghost = ghostFrame?.bodies[0];
    return ghost && Math.hypot(ghost.x - bodies[0].x, ghost.y - bodies[0].y) > 0.01;
  };

  await h.test("forks from an earlier tick; the present method becomes a ghost", async () => {
    await h.restart();
    await h.until(() => slalom.state.newest > 25);
    await h.pause();
    await h.seek((await h.state()).newest - 20);
    await page.click("#fork");
    await page.selectOption("#fork-method", "mppi");
    await page.fill("#fork-options", "samples=-5");
    await page.click("#fork-go");
    await h.says("fork-error", "samples");
    assert.equal(await page.inputValue("#fork-options"), "samples=-5", "the dialog keeps what was typed");
    await page.fill("#fork-options", "samples=640");
    await page.click("#fork-go");
    await h.until(() => slalom.state.ghost === "svg_mppi" && slalom.state.method === "mppi");
    await page.click("#play");
    await h.until(isApart);
    assert.equal(await h.scalar("samples"), 640);
    await h.send({ do: "method", method: "svg_mppi" });
    await h.send({ do: "ghost", method: "" });
    await h.until(() => !slalom.frame.ghostFrame && slalom.state.method === "svg_mppi");
  });

  await h.test("a ghost on the same seed starts beside the car", async () => {
    await h.send({ do: "ghost", method: "mppi" });
    await h.restart();
    await h.until(() => slalom.state.newest > 40);
    await h.until(isApart);
    await h.pause();
    await h.seek(40);
    const gap = await page.evaluate(() => {
      const { frame, scalar } = slalom;
      const laps = ({ scalars }) => scalar("lap", scalars) + scalar("progress", scalars);
      return laps(frame) - laps(frame.ghostFrame);
    });
    assert.ok(Math.abs(gap) < 0.1);
    // The charts have the ghost's lines.
    assert.ok(await page.locator("#faint").isVisible());
    const [head, ...rows] = await h.csv();
    const speed = Number(rows.at(-1)[head.indexOf("ghost_speed [m/s]")]);
    assert.ok(speed > 0.5, `the ghost drives at ${speed} m/s`);
    await h.send({ do: "ghost", method: "" });
    await h.until(() => slalom.state.ghost === "");
    await h.play();
  });
}
