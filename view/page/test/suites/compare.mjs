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
    await h.play();
  });

  await h.test("the best lap drives along as an outline, and the readout has the time behind it", async () => {
    await h.restart();
    await h.pause();
    for (let turns = 0; turns < 12 && !(await h.state()).laps.length; ++turns) {
      const newest = (await h.state()).newest;
      await h.send({ do: "step", ticks: 150 });
      await h.until((t) => slalom.state.newest >= t + 150 && slalom.state.tick === slalom.scalar("tick"), newest);
    }
    const [first] = (await h.state()).laps;
    assert.equal(first.lap, 1);
    assert.equal(first.contacts, 0, "the seed's drive has no collision in its first lap");
    await h.until(() => slalom.best.number === 1 && !slalom.past.missing(Math.max(0, slalom.state.oldest), slalom.state.newest, 1));
    const last = (await h.state()).newest;
    await h.send({ do: "step", ticks: 20 });
    await h.until((t) => slalom.state.newest >= t + 20 && slalom.scalar("tick") === slalom.state.newest, last);
    // The first lap was at this place at most one control step earlier than its first step beyond.
    const [behind, expected, period] = await page.evaluate(() => {
      const column = (name) => slalom.hello.scalars.indexOf(name), progress = slalom.scalar("progress");
      let t = 0;
      while (slalom.past.at(t)[column("progress")] < progress) ++t;
      return [slalom.best.behind(progress, slalom.scalar("lap_time")), slalom.scalar("lap_time") - slalom.past.at(t)[column("lap_time")], slalom.state.control_period];
    });
    assert.ok(behind >= expected - 1e-9 && behind <= expected + period + 1e-9, `${behind} s and ${expected} s`);
    assert.ok(behind < 0, "a lap that begins at speed is ahead of one that began at rest");
    assert.equal(await page.isVisible("#best"), true);
    assert.equal(await page.evaluate(() => document.getElementById("best").firstChild.textContent), "−" + Math.abs(behind).toFixed(2));
    await h.drawn();
    const gap = await page.evaluate(() => Math.hypot(slalom.scene.best.x - slalom.scalar("x"), slalom.scene.best.y - slalom.scalar("y")));
    assert.ok(gap > 0.5, `the best lap is ${gap} m away`);
    await h.picture("best-lap");
    // In the best lap itself the car is where it was.
    await h.send({ do: "seek", tick: 100 });
    await h.until(() => slalom.scalar("tick") === 100);
    assert.equal(await page.evaluate(() => document.getElementById("best").firstChild.textContent), "+0.00");
    await h.play();
  });

  await h.test("the diagram of accelerations shows the grip of the step that is shown", async () => {
    await h.until(() => /^\d+\.\d of \d+\.\d$/.test([...document.querySelectorAll("#charts .chart")].find((c) => c.querySelector(".accelerations")).querySelector("h2 em").textContent));
    const label = await page.evaluate(() => document.querySelector(".accelerations").getAttribute("aria-label"));
    assert.match(label, /^Accelerations of the car along and across, m\/s²; at the step shown \d+\.\d of \d+\.\d$/);
  });
}
