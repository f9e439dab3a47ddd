// The navigator of a mobile robot on the page: goal and obstacles are dragged, options change.
import assert from "node:assert/strict";

export default async function (h) {
  const server = await h.start("view", "--room", "pallet-on-path", "--port", "0");
  const look = await h.open(server.address);
  await h.until(() => window.slalom?.state && slalom.scalar("tick") > 5, null, look);
  const goal = () => look.evaluate(() => slalom.frame.bodies.find((body) => body.kind === 6));
  /** Drags a body by some metres, and waits until it is there. */
  const drag = async (body, dx, dy) => {
    await look.mouse.move(...(await h.placeOf(look, body.x, body.y)));
    await look.mouse.down();
    await look.mouse.move(...(await h.placeOf(look, body.x + dx, body.y + dy)), { steps: 4 });
    await look.mouse.up();
    const isThere = ([id, x, y]) =>
      slalom.frame.bodies.some((b) => b.id === id && Math.hypot(b.x - x, b.y - y) < 0.1);
    await h.until(isThere, [body.id, body.x + dx, body.y + dy], look);
  };

  await h.test("the navigator of a robot in a room is shown, and goes around a pallet", async () => {
    const state = await look.evaluate(() => ({
      lines: slalom.frame.lines.length,
      grid: slalom.hello.problem.title,
      candidates: slalom.frame.candidates.count,
    }));
    assert.deepEqual([state.lines, state.grid], [1, "pallet-on-path"]);
    assert.ok(state.candidates > 50, state.candidates);
    await h.send({ do: "rate", rate: 0 }, look);
    await h.until(() => slalom.hello.statuses[slalom.scalar("status")] === "detour", null, look);
    await h.until(() => document.getElementById("label").textContent.includes("detour"), null, look);
  });

  await h.test("its goal is dragged while the drive is paused, and the path leads there", async () => {
    await h.pause(look);
    const tick = await look.evaluate(() => slalom.scalar("tick"));
    const before = await goal();
    await drag(before, 0, -0.8);
    assert.equal(await look.evaluate(() => slalom.scalar("tick")), tick);
    const [end, now] = [await look.evaluate(() => [...slalom.frame.lines[0].slice(-2)]), await goal()];
    assert.ok(Math.hypot(end[0] - now.x, end[1] - now.y) < 0.2, `${end} is ${now.x}, ${now.y}`);
    await h.send({ do: "play" }, look);
    await h.until(() => slalom.hello.statuses[slalom.scalar("status")] === "goal_reached", null, look);
    const at = await goal();
    const far = await look.evaluate(
      ({ x, y }) => Math.hypot(slalom.scalar("x") - x, slalom.scalar("y") - y),
      at,
    );
    assert.ok(far < 0.2, `${far} m from the goal`);
  });

  await h.test("method and options of a navigator change, and it begins anew", async () => {
    await h.send({ do: "set", key: "problem.max_forward", value: "0.3" }, look);
    await h.send({ do: "method", method: "mppi" }, look);
    await h.until(() => slalom.state.method === "mppi", null, look);
    await h.restart(look);
    await h.until(() => slalom.scalar("tick") > 40, null, look);
    await h.pause(look);
    const speed = await look.evaluate(() => slalom.scalar("state.forward, m/s"));
    assert.ok(speed > 0.2 && speed < 0.31, `${speed} m/s`);
    // A pallet that is dragged into the way is planned around.
    const pallet = await look.evaluate(() => slalom.frame.bodies.find((body) => body.kind === 2));
    const nearest = () =>
      look.evaluate(() => {
        const [box, line] = [slalom.frame.bodies.find((body) => body.kind === 2), slalom.frame.lines[0]];
        const distance = (_, i) => Math.hypot(line[2 * i] - box.x, line[2 * i + 1] - box.y);
        return Math.min(...Array.from({ length: line.length / 2 }, distance));
      });
    const line = await look.evaluate(() => [...slalom.frame.lines[0]]);
    const k = 2 * Math.round(0.2 * line.length);
    await drag(pallet, line[k] - pallet.x, line[k + 1] - pallet.y);
    await h.step(40, look);
    assert.ok((await nearest()) > pallet.width / 2, `the path passes at ${await nearest()} m`);
  });

  await look.close();
  await server.stop();
}
