// Drives the page in Chromium: node test/browser.mjs PROGRAM [PROGRAM WITH A MONITOR]
// SLALOM_SUITES=drive,save runs only these suites, SLALOM_TEST=TEXT only tests whose name contains the text.
import { chromiumPath, Harness } from "./harness.mjs";

const suites =
  "introduction drive compare panes problem room monitor save names layout accessible pages".split(" ");
const chosen = process.env.SLALOM_SUITES?.split(",") ?? suites;
const program = process.argv[2];
if (!program) {
  console.error("usage: browser.mjs PROGRAM");
  process.exit(2);
}
if (!chromiumPath()) {
  console.error("skipped: Chromium is not installed (apt-get install chromium, or set SLALOM_CHROMIUM)");
  process.exit(77);
}
const harness = new Harness(program, process.env.SLALOM_TEST);
harness.monitored = process.argv[3];
await harness.openAll(["--course", "stag", "--obstacles", "4", "--seed", "3"]);
for (const name of chosen) await (await import(`./suites/${name}.mjs`)).default(harness);
await harness.test("no errors are in the console", async () => {
  if (harness.problems.length) throw new Error(harness.problems.join("\n"));
});
await harness.close();
console.log(harness.failed ? `${harness.failed} failed` : "all passed");
process.exit(harness.failed ? 1 : 0);
