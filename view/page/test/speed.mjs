// Measures the page in Chromium without a GPU at 1920 x 1080: node test/speed.mjs PROGRAM
import { Harness } from "./harness.mjs";

const median = (values) => values.sort((a, b) => a - b)[Math.floor(values.length / 2)];
const h = new Harness(process.argv[2]);
const viewport = { width: 1920, height: 1080 };
await h.openAll(["--course", "stag", "--obstacles", "4", "--seed", "3"], { viewport });
const { page } = h;
await h.until(() => window.slalom?.frame && slalom.scalar("tick") > 40);

const seconds = 5;
const frames = await page.evaluate(async (seconds) => {
  const shown = new Set();
  for (const end = performance.now() + 1000 * seconds; performance.now() < end;) {
    await new Promise(requestAnimationFrame);
    shown.add(slalom.scalar("tick"));
  }
  return shown.size / seconds;
}, seconds);
console.log(`${frames.toFixed(1)} frames a second, while the car drives at 1x`);

const edits = [];
await h.pause();
for (let i = 0; i < 15; ++i)
  edits.push(
    await page.evaluate(async () => {
      const { plan, bodies } = slalom.frame;
      const { x, y } = plan[Math.round(plan.length / 3)];
      const begin = performance.now();
      slalom.send({ do: "add", kind: "disc", x, y: y + 2 * Math.random(), length: 0.3 });
      while (slalom.frame.bodies.length === bodies.length) await new Promise((f) => setTimeout(f));
      return performance.now() - begin;
    }),
  );
console.log(`${median(edits).toFixed(0)} ms from an edit while paused to the new plan (median of 15)`);

const plays = [];
for (let i = 0; i < 7; ++i) {
  const { newest } = await h.state();
  await h.seek(Math.max(0, newest - 30 - 3 * i));
  plays.push(
    await page.evaluate(async () => {
      const tick = slalom.scalar("tick");
      const begin = performance.now();
      slalom.send({ do: "play" });
      while (slalom.scalar("tick") === tick) await new Promise((f) => setTimeout(f));
      return performance.now() - begin;
    }),
  );
  await new Promise((done) => setTimeout(done, 1500));
  await h.pause();
}
console.log(`${median(plays).toFixed(0)} ms from Play after going back to the next step (median of 7)`);
await h.close();
