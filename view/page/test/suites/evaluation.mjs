// The laps of an evaluation.
import { execFileSync } from "node:child_process";
import { join } from "node:path";

export default async function (h) {
  await h.test("an evaluation: a click on a collision shows the seconds before it", async () => {
    const out = join(h.folder, "evaluation");
    const drives = ["--methods", "mppi", "--laps", "3", "--obstacles", "6", "--config", "published"];
    const settings = ["--set", "mppi.samples=24", "--out", out];
    execFileSync(h.program, ["eval", "--course", "hare", ...drives, ...settings], { stdio: "ignore" });
    const shown = await h.start("view", "--eval", out, "--port", "0");
    const look = await h.open(shown.address);
    const wait = (what, arg) => h.until(what, arg, look);
    await wait(() => document.querySelector("#evaluation [data-contact]"));
    await look.click("#evaluation [data-contact]");
    await wait(() => slalom.state.contact?.tick >= 0);
    const tick = await look.evaluate(() => slalom.state.contact.tick);
    await wait((t) => slalom.scalar("tick") > 0 && slalom.scalar("tick") < t, tick);
    await wait(
      (t) => slalom.state.paused && slalom.scalar("tick") >= t && slalom.scalar("contacts") > 0,
      tick,
    );
    const { generation } = await h.state(look);
    // The mark on the map: a message that comes or goes above the scene moves it.
    const place = () =>
      look.evaluate(() => {
        slalom.scene.fit();
        slalom.scene.draw();
        const [x, y] = slalom.scene.camera.toScreen(slalom.scene.marks.at(-1).x, slalom.scene.marks.at(-1).y);
        const box = document.querySelector("#scene").getBoundingClientRect();
        return [box.x + x, box.y + y];
      });
    let at = await place();
    for (let before; String(before) !== String(at); at = await place()) {
      before = at;
      await h.drawn(look);
    }
    await look.mouse.click(...at);
    await wait((g) => slalom.state.generation > g && slalom.state.contact, generation);
    await look.close();
    await shown.stop();
  });
}
