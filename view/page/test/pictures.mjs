// Makes the pictures of the page that are looked at, and the README's: node test/pictures.mjs PROGRAM FOLDER
import { spawn } from "node:child_process";
import { existsSync, mkdirSync } from "node:fs";
import { chromium } from "playwright-core";

const [program, folder] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
const executablePath = process.env.SLALOM_CHROMIUM ?? ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
const child = spawn(program, ["view", "--course", "stag", "--obstacles", "5", "--seed", "1", "--port", "0"], { stdio: ["ignore", "pipe", "inherit"] });
const address = await new Promise((resolve) => { let said = ""; child.stdout.on("data", (data) => { said += data; const found = said.match(/http:\S+/); if (found) resolve(found[0]); }); });
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });

async function open(width, height, colorScheme) {
  const page = await browser.newPage({ viewport: { width, height }, colorScheme });
  page.on("pageerror", (error) => console.error(error.message));
  await page.goto(address);
  await page.waitForFunction(() => window.slalom?.frame, undefined, { timeout: 30000 });
  return page;
}
const send = (page, command) => page.evaluate((c) => slalom.send(c), command);
/** Drives tick by tick to a tick, so that the picture is the same on any machine. */
async function driveTo(page, tick) {
  await send(page, { do: "pause" });
  for (;;) {
    const now = await page.evaluate(() => slalom.scalar("tick"));
    if (now >= tick) break;
    await send(page, { do: "step", ticks: Math.min(4, tick - now) }); // few at a time, so that the charts get frames
    await page.waitForFunction((t) => slalom.scalar("tick") > t, now, { timeout: 30000 });
  }
  await page.waitForTimeout(1200);
}
async function shoot(page, name) {
  await page.waitForTimeout(600);
  await page.screenshot({ path: `${folder}/${name}.png` });
  console.log(name);
}

const desktop = await open(1440, 900, "dark");
await send(desktop, { do: "pause" });
await send(desktop, { do: "restart" });
await driveTo(desktop, 196);
await shoot(desktop, "desktop-dark");
await desktop.click("#theme");
await shoot(desktop, "desktop-light");
await desktop.click("#theme");
await driveTo(desktop, 420);
await desktop.evaluate(() => { slalom.scene.camera.zoom = 95; });
await shoot(desktop, "avoidance");
await desktop.close();

const phone = await open(400, 820, "light");
await shoot(phone, "phone-light");
await phone.click("#theme");
await shoot(phone, "phone-dark");
await phone.close();

const pair = await open(1440, 900, "dark");
await send(pair, { do: "ghost", method: "mppi" });
await send(pair, { do: "restart" });
await driveTo(pair, 200);
await shoot(pair, "ghost");
await pair.close();

const wide = await open(2560, 1300, "dark");
await shoot(wide, "wide");
await browser.close();
child.kill("SIGTERM");
