// Draws a picture for the pages and prints its figures (script/pictures): node test/pictures.mjs PROGRAM NAME FILE
import { execFileSync } from "node:child_process";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { Harness } from "./harness.mjs";

const [program, name, file] = process.argv.slice(2);
const ways = "--course stag --config published --obstacles 1 --seed 77 --against mppi --record-all".split(
  " ",
);
const scenarios = { "live-view": [], "two-ways": ways };
const scenario = scenarios[name];
if (!scenario || !file)
  throw new Error(`usage: pictures.mjs PROGRAM ${Object.keys(scenarios).join("|")} FILE`);

const h = new Harness(program);
const isIntroduction = name === "live-view";
const viewport = isIntroduction ? { width: 1440, height: 900 } : { width: 1000, height: 700 };
await h.openAll(scenario, { viewport, colorScheme: isIntroduction ? "dark" : "light" });
const { page } = h;
if (!isIntroduction) {
  await h.restart();
  await h.pause();
}

/** The part of the introduction in which mppi averages and svg_mppi commits. */
async function drawIntroduction() {
  for (let part = 1; part <= 4; ++part) {
    await h.says("introduction-text", `${part} of 5. `);
    if (part < 4) await page.keyboard.press("n");
  }
  await h.drawn();
  return page.screenshot();
}

/** A video of the two controllers, until they have passed the parked car. */
async function filmTwoWays() {
  const end = 64; // control steps, 1.6 s
  const driven = await h.scalar("tick");
  if (driven < end) await h.step(end - driven);
  await page.click("#save-open");
  const recording = join(h.folder, "two-ways.mcap");
  await (await h.saved("#save-recording")).saveAs(recording);
  const span = ["--from", "0.95", "--to", "1.6", "--speed", "0.2"];
  execFileSync(program, ["export", recording, file, ...span], { stdio: "inherit" });
}

if (name === "two-ways") await filmTwoWays();
else writeFileSync(file, await drawIntroduction());
console.log(await page.innerText("body"));
await h.close();
