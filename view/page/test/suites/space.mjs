// The scene in space, and the minimap.
import assert from "node:assert/strict";

export default async function (h) {
  const { page } = h;
  /** Shares of the colours of the scene: how many differ, and how far those around a place of the map are from the free ground. */
  const look = (x, y) => page.evaluate(([mx, my]) => {
    slalom.scene.draw();
    const scene = document.getElementById("scene"), canvas = Object.assign(document.createElement("canvas"), { width: scene.width, height: scene.height }), to = canvas.getContext("2d");
    to.drawImage(scene, 0, 0);
    const all = to.getImageData(0, 0, canvas.width, canvas.height).data, colours = new Set();
    for (let i = 0; i < all.length; i += 4 * 97) colours.add(`${all[i] >> 3} ${all[i + 1] >> 3} ${all[i + 2] >> 3}`);
    const ratio = scene.width / scene.clientWidth, [px, py] = slalom.scene.toScreen(mx, my), half = Math.round(15 * ratio), at = to.getImageData(px * ratio - half, py * ratio - half, 2 * half, 2 * half).data; // all of the car: its windows are dark
    let bright = 0;
    for (let i = 0; i < at.length; i += 4) bright = Math.max(bright, at[i] + at[i + 1] + at[i + 2]);
    return { colours: colours.size, bright };
  }, [x, y]);

  await h.test("C shows the scene in space: walls, car and plans, and C shows it from above again", async () => {
    await h.until(() => window.slalom?.frame?.plan && slalom.state && slalom.scalar("tick") > 20);
    await h.pause();
    const problems = h.problems.length;
    await page.evaluate(() => { document.getElementById("scene").focus(); slalom.scene.camera.follow = "follow"; });
    const zoom = await page.evaluate(() => slalom.scene.camera.zoom);
    await page.keyboard.press("c");
    await h.until(() => slalom.scene.isInSpace && document.getElementById("space").ariaPressed === "true");
    await h.drawn();
    const car = await page.evaluate(() => slalom.frame.bodies[0]), seen = await look(car.x, car.y);
    assert.ok(seen.colours > 40, `the picture has ${seen.colours} colours`);
    assert.ok(seen.bright > 450, `the car is brighter than the ground, ${seen.bright}`);
    await h.picture("space-dark");
    // The place under the pointer, there and back.
    const back = await page.evaluate(() => { const p = slalom.frame.plan.at(-1), [x, y] = slalom.scene.toScreen(p.x, p.y), [mx, my] = slalom.scene.toMap({ x, y }); return Math.hypot(mx - p.x, my - p.y); });
    assert.ok(back < 0.01, `${back} m`);
    // A drag and the arrow keys turn the view.
    const picture = () => page.evaluate(() => { slalom.scene.draw(); return document.getElementById("scene").toDataURL(); });
    const before = await picture(), box = await page.locator("#scene").boundingBox();
    const free = await page.evaluate(() => [[420, 400], [560, 420], [300, 450]].find(([x, y]) => !slalom.scene.bodyAt(...slalom.scene.toMap({ x, y })))); // a body would be dragged itself
    await page.mouse.move(box.x + free[0], box.y + free[1]);
    await page.mouse.down();
    await page.mouse.move(box.x + free[0] + 100, box.y + free[1] + 20, { steps: 4 });
    await page.mouse.up();
    assert.deepEqual(await page.evaluate(() => { const { x, y } = slalom.frame.bodies[0]; return [x, y]; }), [car.x, car.y], "the car stays");
    const dragged = await picture();
    assert.ok(dragged !== before);
    await page.keyboard.press("ArrowLeft");
    await page.keyboard.press("+");
    assert.ok((await picture()) !== dragged);
    await page.keyboard.press("a");
    await h.until(() => slalom.scene.isFitted && document.getElementById("minimap").hidden);
    await h.picture("space-fitted");
    await page.click("#space");
    await h.until(() => !slalom.scene.isInSpace);
    await page.evaluate((z) => Object.assign(slalom.scene.camera, { follow: "follow", zoom: z }), zoom);
    const above = await look(car.x, car.y);
    assert.ok(above.colours > 40 && above.bright > 450, `from above: ${JSON.stringify(above)}`);
    const [left, right] = await page.evaluate(() => { const b = slalom.frame.bodies[0]; return [slalom.scene.toScreen(b.x - 1, b.y), slalom.scene.toScreen(b.x + 1, b.y)]; });
    assert.ok(Math.abs(right[0] - left[0] - 2 * zoom) < 0.01 && Math.abs(right[1] - left[1]) < 0.01, "in the scale of the map again");
    assert.equal(h.problems.length, problems, h.problems.slice(problems).join());
  });

  await h.test("a minimap shows the course while only a part of it is in view", async () => {
    await page.evaluate(() => { slalom.scene.camera.follow = "follow"; });
    await h.until(() => { const map = document.getElementById("minimap"); return !map.hidden && map.width > 40; });
    const colours = await page.evaluate(() => { const map = document.getElementById("minimap"), all = map.getContext("2d").getImageData(0, 0, map.width, map.height).data, found = new Set(); for (let i = 0; i < all.length; i += 4) if (all[i + 3] > 200) found.add(`${all[i] >> 4} ${all[i + 1] >> 4} ${all[i + 2] >> 4}`); return found.size; });
    assert.ok(colours > 2, "course and car");
    const covers = await page.evaluate(() => { const map = document.getElementById("minimap").getBoundingClientRect(), stage = document.getElementById("stage").getBoundingClientRect(); return slalom.frame.plan.filter((p) => { const [x, y] = slalom.scene.toScreen(p.x, p.y); return x + stage.x > map.left && y + stage.y > map.top && y + stage.y < map.bottom; }).length; });
    assert.equal(covers, 0, "states of the plan under the minimap");
    await page.keyboard.press("a");
    await h.until(() => document.getElementById("minimap").hidden);
    await page.keyboard.press("f");
  });

  await h.test("without WebGL 2 the page says so, and everything but the scene works", async () => {
    const other = await h.open();
    await other.addInitScript(() => { const get = HTMLCanvasElement.prototype.getContext; HTMLCanvasElement.prototype.getContext = function (kind, ...more) { return kind === "webgl2" ? null : get.call(this, kind, ...more); }; });
    await other.goto(h.server.address);
    await h.until(() => window.slalom?.frame && slalom.state && document.querySelector("#charts canvas"), undefined, other);
    assert.deepEqual(await other.evaluate(() => [document.getElementById("space").disabled, /WebGL 2/.test(document.getElementById("space").title), document.getElementById("no-picture").checkVisibility()]), [true, true, true]);
    await other.close();
    await h.send({ do: "play" });
  });
}
