// The laps of an evaluation.
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
}
