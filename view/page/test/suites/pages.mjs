// Several pages, a slow one, and a lost connection.
import assert from "node:assert/strict";

export default async function (h) {
  const { page } = h;

  await h.test("a slow browser pauses at the newest tick, and frames do not pile up", async () => {
    const tools = await page.context().newCDPSession(page);
    await tools.send("Emulation.setCPUThrottlingRate", { rate: 6 });
    await h.play();
    await page.evaluate(() => {
      Object.assign(window, { from: slalom.scalar("tick"), most: 0 });
      const measure = () => {
        window.most = Math.max(window.most, slalom.waiting());
        requestAnimationFrame(measure);
      };
      measure();
    });
    await h.until(() => slalom.scalar("tick") > window.from + 80); // long enough that frames would pile up
    await h.press("play");
    await h.isPaused();
    const seen = await h.state();
    assert.ok((await page.evaluate(() => window.most)) <= 2, "at most two frames wait in the page");
    assert.equal(seen.tick, seen.newest, "the pause shows the newest tick");
    await tools.send("Emulation.setCPUThrottlingRate", { rate: 1 });
    await h.play();
  });

  await h.test("one page drives; another watches, and takes over", async () => {
    const other = await h.open(page.url());
    await other.until(() => window.slalom?.frame && slalom.state);
    await other.hides("take-over", false);
    const { generation } = await h.state();
    await other.send({ do: "restart" });
    await other.says("toast", "take over");
    assert.equal((await h.state()).generation, generation, "a page that watches cannot restart");
    await other.page.click("#take-over");
    await other.hides("take-over");
    await h.hides("take-over", false);
    await other.page.click("#restart");
    await h.until((g) => slalom.state.generation > g, generation);
    await other.page.close();
    await h.hides("take-over"); // the page that is left drives
    await h.restart();
  });

  await h.test("says that the connection is lost, and shows what a new server drives", async () => {
    const problems = h.problems.length;
    await h.server.stop();
    await h.hides("lost", false);
    h.server = await h.start("view", "--course", "stag", "--seed", "5", "--port", h.server.port);
    await h.until(() => document.getElementById("lost").hidden && slalom.state?.seed === "5");
    await h.until(() => location.hash.includes("seed=5"));
    h.problems.length = problems; // Chromium reports the attempts to connect in the console
  });
}
