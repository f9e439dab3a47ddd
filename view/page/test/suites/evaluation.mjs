// The laps of an evaluation.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { join } from "node:path";

export default async function (h) {
  await h.test("an evaluation: a click on a collision shows the seconds before it", async () => {
    const out = join(h.folder, "evaluation");
    execFileSync(h.program, ["eval", "--course", "hare", "--methods", "mppi", "--laps", "3", "--obstacles", "6", "--config", "published", "--set", "mppi.samples=24", "--out", out], { stdio: "ignore" });
    const shown = await h.start("view", "--eval", out, "--port", "0"), look = await h.open(shown.address);
    const wait = (what, arg) => h.until(what, arg, look);
    await wait(() => document.querySelector("#evaluation [data-contact]"));
    const contact = await look.getAttribute("#evaluation [data-contact]", "data-contact");
    await look.click("#evaluation [data-contact]");
    await wait((c) => slalom.state.contact && [slalom.state.contact.experiment, slalom.state.contact.lap, slalom.state.contact.contact].join("/") === c, contact);
    const tick = await look.evaluate(() => slalom.state.contact.tick);
    await wait((t) => slalom.scalar("tick") > 0 && slalom.scalar("tick") < t && slalom.scalar("contact") === 0, tick);
    await wait((t) => slalom.state.paused && slalom.scalar("tick") >= t && slalom.scalar("contacts") > 0, tick);
    await h.picture("evaluation", look);
    const generation = await look.evaluate(() => slalom.state.generation);
    // Where the mark is on the page now: a message that comes or goes above the scene moves it.
    const mark = () => look.evaluate(() => {
      slalom.scene.fit();
      slalom.scene.draw();
      const m = slalom.scene.marks.at(-1), [x, y] = slalom.scene.camera.toScreen(m.x, m.y), box = document.querySelector("#scene").getBoundingClientRect();
      return [box.x + x, box.y + y];
    });
    let at = await mark();
    for (let before; String(before) !== String(at); at = await mark()) { before = at; await h.drawn(look); }
    await look.mouse.click(...at);
    await wait((g) => slalom.state.generation > g && slalom.state.contact, generation);
    await look.close();
    await shown.stop();
  });

  await h.test("names from files are text, and no script but the page's own runs", async () => {
    const hostile = "<img src=x onerror='window.broken = 1'><script>window.broken = 2<\/script>";
    const out = join(h.folder, hostile.replaceAll("/", "&sol;"));
    execFileSync(h.program, ["eval", "--course", "wren", "--methods", "mppi", "--scenario", "pt", "--laps", "1", "--set", "mppi.samples=64", "--out", out], { stdio: "ignore" });
    const shown = await h.start("view", "--eval", out, "--port", "0"), look = await h.open(shown.address);
    await h.until(() => document.querySelector("#evaluation p")?.textContent.includes("<img src=x onerror="), null, look);
    assert.equal(await look.locator("#evaluation img").count(), 0);
    const problems = h.problems.length;
    const ran = await look.evaluate(() => new Promise((done) => {
      document.addEventListener("securitypolicyviolation", () => setTimeout(() => done(window.broken ?? "nothing"), 100));
      document.body.insertAdjacentHTML("beforeend", "<img src='data:,' onerror='window.broken = 1'>");
      setTimeout(() => done("no violation"), 20_000);
    }));
    h.problems.length = problems; // Chromium reports the violation in the console
    assert.equal(ran, "nothing");
    await look.close();
    await shown.stop();
  });
}
