// A slow browser: the page follows the server, and commands do not wait behind frames.
import assert from "node:assert/strict";

const slowdown = 6; // of the browser's processor
const max_lag = 0.3; // s of simulated time between the tick shown at the click and that of the pause
const max_waiting = 2; // frames

export default async function (h) {
  await h.test("a slow browser pauses at the tick that it shows, and frames do not pile up", async () => {
    const page = await h.open(h.server.address), tools = await page.context().newCDPSession(page);
    await h.until(() => window.slalom?.frame && slalom.state, undefined, page);
    await tools.send("Emulation.setCPUThrottlingRate", { rate: slowdown });
    for (let attempt = 0; attempt < 2; ++attempt) {
      await page.evaluate(() => {
        slalom.send({ do: "play" });
        Object.assign(window, { from: slalom.received, waiting: 0, longest: 0 });
        let last = performance.now();
        const measure = () => {
          const now = performance.now();
          longest = Math.max(longest, now - last);
          last = now;
          waiting = Math.max(waiting, slalom.waiting);
          if (!slalom.state.paused || slalom.received <= from + 10) requestAnimationFrame(measure);
        };
        measure();
      });
      // Long enough that frames would pile up: the server makes 40 ticks a second.
      await h.until(() => slalom.received > from + 10, undefined, page);
      const tick = await page.evaluate(() => { const shown = slalom.scalar("tick"); document.getElementById("play").click(); return shown; });
      await h.until(() => slalom.state.paused && slalom.state.tick === slalom.scalar("tick"), undefined, page);
      const seen = await page.evaluate(() => ({ tick: slalom.state.tick, period: slalom.state.control_period, longest: longest / 1000, waiting }));
      const lag = (seen.tick - tick) * seen.period;
      console.log(`      paused ${lag.toFixed(2)} s after the tick shown; a draw takes up to ${seen.longest.toFixed(2)} s`);
      assert.ok(seen.waiting <= max_waiting, `${seen.waiting} frames waited in the page`);
      assert.ok(Math.abs(lag) <= max_lag, `the pause holds ${lag.toFixed(2)} s after the tick shown`);
    }
    await tools.send("Emulation.setCPUThrottlingRate", { rate: 1 });
    await page.close();
    await h.send({ do: "play" });
    await h.until(() => !slalom.state.paused);
  });
}
