// The navigator of a mobile robot on the page: its path and its goal, which is dragged.
import assert from "node:assert/strict";

export default async function (h) {
  const server = await h.start("view", "--room", "pallet-on-path", "--port", "0");
  const look = await h.open(server.address);
  const { page } = look;
  await look.until(() => window.slalom?.state && slalom.scalar("tick") > 5);
  const goal = () => page.evaluate(() => slalom.frame.bodies.find((body) => body.kind === 6));

  await h.test("the navigator of a robot in a room is shown, and goes around a pallet", async () => {
    const state = await page.evaluate(() => ({
      lines: slalom.frame.lines.length,
      grid: slalom.hello.title,
      candidates: slalom.frame.candidates.count,
    }));
    assert.deepEqual([state.lines, state.grid], [1, "pallet-on-path"]);
    assert.ok(state.candidates > 50, state.candidates);
    await look.send({ do: "rate", rate: 0 });
    const why = "The path is blocked; this is the way around.";
    await look.until((text) => document.getElementById("why").textContent === text, why);
    await look.pause();
    assert.match(await page.textContent("#label"), /detour/);
  });

  await h.test("its goal is dragged while the drive is paused, and the path leads there", async () => {
    await look.pause();
    const tick = await look.scalar("tick");
    const { id, x, y } = await goal();
    const to = { x, y: y - 0.8 };
    await look.drag(await look.placeOf({ x, y }), await look.placeOf(to));
    const isThere = ([id, x, y]) =>
      slalom.frame.bodies.some((b) => b.id === id && Math.hypot(b.x - x, b.y - y) < 0.1);
    await look.until(isThere, [id, to.x, to.y]);
    assert.equal(await look.scalar("tick"), tick);
    const end = await page.evaluate(() => [...slalom.frame.lines[0].slice(-2)]);
    const now = await goal();
    assert.ok(Math.hypot(end[0] - now.x, end[1] - now.y) < 0.2, `${end} is ${now.x}, ${now.y}`);
  });

  await page.close();
  await server.stop();
}
