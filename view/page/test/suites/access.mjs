// Keys, foreign pages, errors and a lost connection.
import assert from "node:assert/strict";

export default async function (h) {
  const { page } = h;

  await h.test("keys are explained", async () => {
    await page.focus("#scene");
    await page.keyboard.press("?");
    await h.until(() => document.getElementById("help-box").open);
    await h.picture("help");
    await page.keyboard.press("Escape");
    await h.until(() => !document.getElementById("help-box").open);
  });

  await h.test("the page of another origin cannot connect", async () => {
    const other = await h.browser.newPage();
    await other.goto("data:text/html,<p>elsewhere</p>");
    const outcome = await other.evaluate((port) => new Promise((done) => { const s = new WebSocket(`ws://127.0.0.1:${port}/ws`); s.onopen = () => done("open"); s.onerror = () => done("refused"); }), h.server.port);
    assert.equal(outcome, "refused");
    await other.close();
  });

  await h.test("loads without errors in the console", async () => assert.deepEqual(h.problems, []));

  await h.test("says that the connection is lost, and offers to restore the scenario on a new server", async () => {
    await h.send({ do: "set", key: "svg_mppi.samples", value: "555" });
    await h.until(() => location.hash.includes("svg_mppi.samples=555"));
    const mine = await page.evaluate(() => location.hash), seed = (await h.state()).seed;
    const restart = async () => {
      await h.server.stop();
      await h.until(() => !document.getElementById("lost").hidden);
      h.server = await h.start("view", "--course", "stag", "--seed", "5", "--port", h.server.port);
      await h.until(() => document.getElementById("lost").hidden && slalom.state?.seed === "5" && !document.getElementById("restore").hidden);
    };
    await restart();
    assert.equal(await page.evaluate(() => location.hash), mine, "the address keeps the scenario");
    await h.picture("restore");
    await page.click("#restore-mine");
    await h.until((s) => slalom.state.seed === s && slalom.scalar("samples") === 555 && slalom.scalar("tick") > 3 && document.getElementById("restore").hidden, seed);
    await h.until((address) => location.hash === address, mine);
    await restart();
    await page.click("#restore-not");
    await h.until(() => location.hash.includes("seed=5") && !location.hash.includes("555"));
  });
}
