// The page that a new user sees: the address that the program prints without arguments.
import assert from "node:assert/strict";

const begins = [0, 3, 6, 10, 22]; // steps of the recording with which the parts begin
const words = [
  "Two methods",
  "The plan",
  "svg_mppi first improves a guide",
  "Two ways lead around",
  "mppi hits the car",
];
const keys = [" ", ".", ",", "r", "f", "a", "g", "ArrowLeft", "+", "l", "t", "n"];

export default async function (h) {
  await h.until(() => window.slalom?.frame && slalom.state);
  await h.pause(); // the other pages need the processor, too
  const server = await h.start("view", "--port", "0");
  /** Opens the introduction. */
  async function open(address = server.address, options = {}) {
    const tab = await h.open(address, options);
    await tab.until(() => window.slalom?.frame?.ghostFrame && slalom.state?.paused);
    return tab;
  }
  /** The step, the text and the captions of a page. */
  const told = (page) =>
    page.evaluate(() => [
      slalom.scalar("tick"),
      document.getElementById("introduction").checkVisibility() &&
        document.getElementById("introduction-text").textContent,
      ...[...document.querySelectorAll(".caption")].map((each) => (each.hidden ? "" : each.textContent)),
    ]);
  /** Checks that a page tells what belongs to its step, whatever led there. */
  async function check(page, what) {
    const [tick, text, ...captions] = await told(page);
    const part = begins.findLastIndex((from) => from <= tick);
    assert.ok(text && text.startsWith(`${part + 1} of 5. ${words[part]}`), `${what}: ${tick}, ${text}`);
    const isExplained = part >= 3;
    if (tick <= begins[4])
      assert.equal(captions.some(Boolean), isExplained, `${what}: ${captions} before they are explained`);
    for (const shares of captions
      .map((each) => [...each.matchAll(/(\d+)\u00a0%/g)])
      .filter((all) => all.length))
      assert.equal(
        shares.reduce((sum, [, share]) => sum + Number(share), 0),
        100,
        captions.join(),
      );
    return captions;
  }

  await h.test(
    "the address without arguments is a recording that explains two controllers in five parts",
    async () => {
      assert.match(server.address, /\/introduction$/);
      const tab = await open();
      const { page } = tab;
      assert.ok(
        await page.evaluate(() => slalom.stage.isSideBySide() && document.getElementById("layers").open),
      );
      let captions;
      for (const [i, begin] of begins.entries()) {
        await tab.until((t) => slalom.scalar("tick") === t, begin);
        await tab.drawn();
        captions = await check(page, `part ${i + 1}`);
        if (i === 3) {
          assert.match(captions[0], /^svg_mppi commits: /);
          assert.match(captions[1], /^mppi averages: .* left, .* right/);
        }
        if (i < 4) await page.keyboard.press("n");
      }
      assert.match(captions[1], /^mppi hits: /);
      assert.equal(
        await page.evaluate(() => slalom.frame.ghostFrame.bodies[0].touched),
        true,
        "the cross is drawn there",
      );
      // Play drives on through the parts, to the end.
      await page.keyboard.press("n");
      await page.selectOption("#rate", "1");
      await page.click("#play");
      await tab.until(() => slalom.state.paused && slalom.state.tick === slalom.state.newest);
      await check(page, "after Play");
      await page.close();
    },
  );

  await h.test(
    "every control and key in every part leaves the introduction as it is, by pointer and touch",
    async () => {
      for (const options of [{}, { hasTouch: true, viewport: { width: 390, height: 844 } }]) {
        const tab = await open(server.address, options);
        const { page } = tab;
        const controls = await page.evaluate(() => {
          const all = [...document.querySelectorAll("button, select, input, summary")].filter((e) =>
            e.checkVisibility(),
          );
          return all.map((e, i) => (e.id ||= `control-${i}`)).filter((id) => id !== "save-png");
        });
        assert.ok(controls.length > 18, controls.join());
        for (const begin of begins) {
          for (const act of [...controls, ...keys]) {
            await tab.send({ do: "pause" });
            await tab.send({ do: "seek", tick: begin });
            await tab.until((t) => slalom.scalar("tick") === t, begin);
            if (keys.includes(act)) await page.focus("#scene").then(() => page.keyboard.press(act));
            else await tab.press(act);
            await tab.send({ do: "pause" });
            await page.evaluate(() => slalom.layers.show("modes", slalom.scalar("tick") >= 10));
            await tab.drawn();
            await check(page, `${act} at ${begin}`);
            await page.evaluate(() => document.querySelector("dialog[open]")?.close());
          }
        }
        await page.close();
      }
    },
  );

  await h.test("the verdicts are those of the steps on a processor without SIMD, too", async () => {
    const { SLALOM_TARGET } = process.env;
    process.env.SLALOM_TARGET = "generic";
    const plain = await h.start("view", "--port", "0");
    if (SLALOM_TARGET) process.env.SLALOM_TARGET = SLALOM_TARGET;
    else delete process.env.SLALOM_TARGET;
    const tab = await open(plain.address);
    for (const [tick, verdicts] of [
      [10, ["commits", "averages"]],
      [22, ["commits", "hits"]],
    ]) {
      await tab.send({ do: "seek", tick });
      await tab.until((t) => slalom.scalar("tick") === t, tick);
      await tab.drawn();
      const found = await tab.page
        .locator(".caption")
        .evaluateAll((all) => all.map((e) => e.dataset.verdict));
      assert.deepEqual(found, verdicts);
    }
    await tab.page.close();
    await plain.stop();
  });

  await h.test("it leads to the drive itself, and a menu leads back", async () => {
    const tab = await open();
    const { page } = tab;
    await tab.send({ do: "seek", tick: 30 });
    await page.click("#introduction-without");
    await tab.until(
      () => window.slalom?.frame?.ghostFrame && slalom.stage.isSideBySide() && !slalom.isReplay,
    );
    await tab.until(() => slalom.options.changed.includes("svg_mppi.adapt_covariance=false"));
    assert.equal((await tab.state()).ghost, "mppi");
    const distance = await page.evaluate(() => {
      const { camera, ghostCamera, placeCameras, placeOf } = slalom.stage;
      placeCameras();
      const { left, top } = document.getElementById("scene").getBoundingClientRect();
      const at = { x: ghostCamera.left + 20, y: ghostCamera.top + 20 };
      const p = placeOf({ clientX: left + at.x, clientY: top + at.y });
      const [there, same] = [ghostCamera.toMap(at.x, at.y), camera.toMap(p.x, p.y)];
      return Math.hypot(there[0] - same[0], there[1] - same[1]);
    });
    assert.ok(distance < 1e-6, "a point of the ghost's lane is the same place in the car's");
    await page.focus("#scene");
    await page.keyboard.press("g");
    await tab.until(() => !slalom.stage.isSideBySide());
    await page.keyboard.press("?");
    await page.click("#introduction-open");
    await tab.until(() => window.slalom?.frame && slalom.isReplay);
    await tab.says("introduction-text", "1 of 5. ");
    await page.click("#introduction-close");
    await tab.until(() => window.slalom?.frame && !slalom.isReplay);
    await page.close();
  });
  await server.stop();
  await h.play();
}
