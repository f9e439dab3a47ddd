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
    await look.until(() => document.querySelector("#evaluation [data-contact]"));
    await look.page.click("#evaluation [data-contact]");
    await look.until(() => slalom.state.contact?.tick >= 0);
    const { tick } = (await look.state()).contact;
    await look.until((t) => slalom.scalar("tick") > 0 && slalom.scalar("tick") < t, tick);
    const isHit = (t) => slalom.state.paused && slalom.scalar("tick") >= t && slalom.scalar("contacts") > 0;
    await look.until(isHit, tick);
    const { generation } = await look.state();
    // The mark on the map: a message that comes or goes above the scene moves it.
    const place = async () => {
      await look.page.evaluate(() => slalom.scene.fit());
      return look.placeOf(await look.page.evaluate(() => slalom.scene.marks.at(-1)));
    };
    let at = await place();
    for (let before; String(before) !== String(at); at = await place()) {
      before = at;
      await look.drawn();
    }
    await look.page.mouse.click(...at);
    await look.until((g) => slalom.state.generation > g && slalom.state.contact, generation);
    await look.page.close();
    await shown.stop();
  });
}
