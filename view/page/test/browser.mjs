// Drives the page in Chromium: node test/browser.mjs PROGRAM [SCREENSHOT_FOLDER]
// SLALOM_SUITES=drive,access runs only these suites, SLALOM_TEST=TEXT only the tests whose name contains the text.
import { chromiumPath, Harness } from "./harness.mjs";
import access from "./suites/access.mjs";
import accessible from "./suites/accessible.mjs";
import compare from "./suites/compare.mjs";
import drive from "./suites/drive.mjs";
import evaluation from "./suites/evaluation.mjs";
import hostile from "./suites/hostile.mjs";
import introduction from "./suites/introduction.mjs";
import layout from "./suites/layout.mjs";
import past from "./suites/past.mjs";
import responsive from "./suites/responsive.mjs";
import save from "./suites/save.mjs";
import space from "./suites/space.mjs";

const suites = { introduction, drive, space, responsive, compare, past, save, evaluation, hostile, layout, accessible, access };
const chosen = process.env.SLALOM_SUITES?.split(",") ?? Object.keys(suites);
const program = process.argv[2], pictures = process.argv[3];
if (!program) {
  console.error("usage: browser.mjs PROGRAM [SCREENSHOT_FOLDER]");
  process.exit(2);
}
if (!chromiumPath()) {
  console.error("skipped: Chromium is not installed (apt-get install chromium, or set SLALOM_CHROMIUM)");
  process.exit(77);
}
const harness = new Harness(program, pictures, process.env.SLALOM_TEST);
await harness.open_all();
await harness.page.goto(harness.server.address);
for (const [name, suite] of Object.entries(suites)) if (chosen.includes(name)) await suite(harness);
await harness.close();
console.log(harness.failed ? `${harness.failed} failed` : "all passed");
process.exit(harness.failed ? 1 : 0);
