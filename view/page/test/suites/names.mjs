// Names in files that are HTML: they are shown as text, and no script runs but the page's own.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { gunzipSync, gzipSync } from "node:zlib";

/** A name that runs a script wherever it is taken for HTML: in an attribute, in a script or in text. */
const name = `"'><img src=x onerror="window.broken=1"></script><script>window.broken=1</script>`;
const keys = ["course", "description", "method", "methods", "config", "courses", "configurations", "name"];
keys.push("symbol", "unit", "help", "command_line", "ghost", "ghost_label", "changed");

/** A message of the server in which each name is hostile. */
function tainted(value, key) {
  if (Array.isArray(value)) return value.map((each) => tainted(each, key));
  if (value !== null && typeof value === "object")
    return Object.fromEntries(Object.entries(value).map(([k, each]) => [k, tainted(each, k)]));
  return typeof value === "string" && value && keys.includes(key) ? name : value;
}

/** A segment of a recording with hostile names: messages of a kind (a byte; 0: text), a length, content. */
function taintedSegment(packed) {
  const bytes = gunzipSync(packed);
  const parts = [];
  for (let at = 0; at < bytes.length;) {
    const [kind, length] = [bytes[at], bytes.readUInt32LE(at + 1)];
    let content = bytes.subarray(at + 5, at + 5 + length);
    at += 5 + length;
    if (kind === 0) {
      const message = tainted(JSON.parse(content.toString()));
      if (message.type === "state")
        message.laps = [{ lap: 1, time: 9, contacts: 0, method: name, ghost: false }];
      content = Buffer.from(JSON.stringify(message));
    }
    const head = Buffer.alloc(5);
    head.writeUInt8(kind);
    head.writeUInt32LE(content.length, 1);
    parts.push(head, content);
  }
  return gzipSync(Buffer.concat(parts));
}

export default async function (h) {
  await h.test("names in a crafted replay are text", async () => {
    const [lap, html] = [join(h.folder, "plain.mcap"), join(h.folder, "hostile.html")];
    const drive = "drive --course wren --method mppi --set mppi.samples=64 --record".split(" ").concat(lap);
    execFileSync(h.program, drive, { stdio: "ignore" });
    execFileSync(h.program, ["export", lap, html], { stdio: "ignore" });
    const segment = /(<script type="application\/x-slalom-replay">)([^<]*)/g;
    const replaced = (_, tag, text) => tag + taintedSegment(Buffer.from(text, "base64")).toString("base64");
    writeFileSync(html, readFileSync(html, "utf8").replace(segment, replaced));
    const look = await h.open("file://" + html);
    await look.until(() => slalom.frame && document.querySelector("#command")?.textContent);
    await look.press("all-options");
    for (const id of ["caption", "about", "laps", "label", "option-list", "command"])
      await look.says(id, name);
    await look.drawn();
    await look.page.evaluate(() => new Promise((done) => setTimeout(done, 200))); // images report late
    const broken = await look.page.evaluate(() => window.broken ?? "nothing");
    assert.equal(broken, "nothing", "no script of a name runs");
    assert.equal(await look.page.locator("img[src=x], script:not([type])").count(), 0);
    await look.page.close();
  });

  await h.test("no script but the page's own runs", async () => {
    const { page } = await h.open(h.server.address);
    const problems = h.problems.length;
    const ran = await page.evaluate(() => {
      const violation = new Promise((done) => document.addEventListener("securitypolicyviolation", done));
      document.body.insertAdjacentHTML("beforeend", "<img src='data:,' onerror='window.broken = 1'>");
      return violation.then(() => window.broken ?? "nothing");
    });
    h.problems.length = problems; // Chromium reports the violation in the console
    assert.equal(ran, "nothing");
    await page.close();
    if (process.env.SLALOM_PAGE) return;
    const answer = await fetch(h.server.address);
    assert.equal(answer.headers.get("content-security-policy"), "frame-ancestors 'none'");
  });
}
