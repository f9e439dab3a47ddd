// Names in files that are HTML: they are shown as text, and no script runs but the page's own.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { cpSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { gunzipSync, gzipSync } from "node:zlib";

/** A name of this kind that runs a script wherever it is taken for HTML, in an attribute, in a script or in text. */
const name = (kind) => `${kind}"'><img src=x onerror="window.broken='${kind}'"></script><script>window.broken='${kind}'</script>`;
const kinds = { course: "course", description: "description", method: "method", methods: "method", config: "config", courses: "course", configurations: "config", name: "option", symbol: "symbol", unit: "unit", help: "help", command_line: "command", ghost: "ghost", ghost_label: "ghost", changed: "option" };

/** A message of the server in which each name is hostile. */
function tainted(value, key) {
  if (Array.isArray(value)) return value.map((each) => tainted(each, key));
  if (value !== null && typeof value === "object") return Object.fromEntries(Object.entries(value).map(([k, each]) => [k, tainted(each, k)]));
  return typeof value === "string" && value && kinds[key] ? name(kinds[key]) : value;
}

/** A segment of a recording with hostile names: messages of one byte for the kind, 0 for text, and a length. */
function taintedSegment(packed) {
  const bytes = gunzipSync(packed), parts = [];
  for (let at = 0; at < bytes.length; ) {
    const kind = bytes[at], length = bytes.readUInt32LE(at + 1);
    let content = bytes.subarray(at + 5, at + 5 + length);
    at += 5 + length;
    if (kind === 0) {
      const message = tainted(JSON.parse(content.toString()));
      if (message.type === "state") message.laps = [{ lap: 1, time: 9, contacts: 0, method: name("lap"), ghost: false }];
      content = Buffer.from(JSON.stringify(message));
    }
    const head = Buffer.alloc(5);
    head.writeUInt8(kind);
    head.writeUInt32LE(content.length, 1);
    parts.push(head, content);
  }
  return gzipSync(Buffer.concat(parts));
}

const u16 = (value) => { const b = Buffer.alloc(2); b.writeUInt16LE(value); return b; };
const u32 = (value) => { const b = Buffer.alloc(4); b.writeUInt32LE(value); return b; };
const u64 = (value) => { const b = Buffer.alloc(8); b.writeBigUInt64LE(BigInt(value)); return b; };
const string = (text) => Buffer.concat([u32(Buffer.byteLength(text)), Buffer.from(text)]);
const record = (op, ...parts) => { const content = Buffer.concat(parts); return Buffer.concat([Buffer.from([op]), u64(content.length), content]); };

/** An MCAP file with these segments and hostile names of profile, schema, topic and media type. It has no index, as a recording that was cut. */
function mcap(segments) {
  return Buffer.concat([
    Buffer.from([0x89]), Buffer.from("MCAP0\r\n"),
    record(0x01, string(name("profile")), string(name("library"))),
    record(0x03, u16(1), string(name("schema")), string("jsonschema"), string("{}")),
    record(0x04, u16(0), u16(1), string("/" + name("topic")), string("json"), u32(0)),
    ...segments.map((segment, i) => record(0x09, u64(0), u64(0), string(`replay/${String(i).padStart(5, "0")}.gz`), string(name("media")), u64(segment.length), segment, u32(0))),
    record(0x0f, u32(0)),
  ]);
}

export default async function (h) {
  /** That the page shows these names as text, and that nothing of them became an element or ran. */
  async function isHarmless(look, shown) {
    for (const [id, kind] of shown) await h.until(([i, text]) => document.getElementById(i)?.textContent.includes(text), [id, name(kind)], look);
    await h.drawn(look);
    await look.evaluate(() => new Promise((done) => setTimeout(done, 200))); // an image that cannot be loaded reports late
    assert.equal(await look.evaluate(() => window.broken ?? "nothing"), "nothing", "no script of a name runs");
    assert.equal(await look.locator("img[src=x]").count(), 0);
    assert.equal(await look.locator("script:not([type])").count(), 0);
  }

  await h.test("names in a crafted recording are text, in the exported page and in that of slalom replay", async () => {
    const plain = join(h.folder, "plain.mcap"), page = join(h.folder, "plain.html"), file = join(h.folder, "hostile.mcap"), html = join(h.folder, "hostile.html");
    execFileSync(h.program, ["drive", "--course", "wren", "--method", "mppi", "--set", "mppi.samples=64", "--record", plain], { stdio: "ignore" });
    execFileSync(h.program, ["replay", plain, "--html", page], { stdio: "ignore" });
    const segments = [...readFileSync(page, "utf8").matchAll(/<script type="application\/x-slalom-replay">([^<]*)<\/script>/g)].map(([, text]) => taintedSegment(Buffer.from(text, "base64")));
    assert.ok(segments.length > 0);
    writeFileSync(file, mcap(segments));
    execFileSync(h.program, ["replay", file, "--html", html], { stdio: "ignore" });
    const problems = h.problems.length, shown = await h.start("replay", file, "--port", "0");
    for (const address of ["file://" + html, shown.address]) {
      const look = await h.open(address);
      await h.until(() => window.slalom?.replay && slalom.frame && slalom.state, undefined, look);
      await h.until(() => document.querySelector("#command")?.textContent, undefined, look);
      await look.evaluate(() => document.getElementById("all-options").click());
      await isHarmless(look, [["caption", "course"], ["caption", "method"], ["about", "description"], ["laps", "lap"], ["label", "method"], ["option-list", "option"], ["command", "command"]]);
      await look.close();
    }
    assert.deepEqual(h.problems.slice(problems), [], "nothing was refused by the policy: the names became no elements");
    await shown.stop();
  });

  await h.test("the name of a course's folder is text in the live page", async () => {
    const folder = join(h.folder, "<img src=x onerror=window.broken='course'>");
    cpSync(fileURLToPath(new URL("../../../../courses/wren", import.meta.url)), folder, { recursive: true });
    const shown = await h.start("view", "--course", folder, "--port", "0"), look = await h.open(shown.address);
    await h.until(() => slalom.state?.course.includes("<img") && document.getElementById("command")?.textContent.includes("onerror="), undefined, look);
    await isHarmless(look, []);
    await look.close();
    await shown.stop();
  });

  await h.test("the server sends the policy of the page as a header", async () => {
    if (process.env.SLALOM_PAGE) return;
    const answer = await fetch(h.server.address), policy = (await answer.text()).match(/<meta http-equiv="Content-Security-Policy" content="([^"]*)"/)[1];
    assert.equal(answer.headers.get("content-security-policy"), policy + "; frame-ancestors 'none'");
  });
}
