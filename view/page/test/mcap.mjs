// Reads recordings with the programs of others: node test/mcap.mjs PROGRAM [FILE.mcap]...
// Without files it records a lap first, twice, and once with times.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { loadDecompressHandlers } from "@mcap/support";
import Ajv from "ajv";
import schemas from "@foxglove/schemas/jsonschema.js";

const program = process.argv[2];
const decompressHandlers = await loadDecompressHandlers();
const decoder = new TextDecoder();
const ajv = new Ajv();

/** A schema without its explanations. */
function bare(schema) {
  if (Array.isArray(schema)) return schema.map(bare);
  if (schema === null || typeof schema !== "object") return schema;
  const words = ["title", "description", "$comment"];
  const demands = Object.entries(schema).filter(([key, v]) => !words.includes(key) || typeof v !== "string");
  return Object.fromEntries(demands.map(([key, value]) => [key, bare(value)]));
}

/** The topics and figures that the layouts for other programs show. */
function shownByLayouts() {
  const read = (name) => readFileSync(new URL("../../layouts/" + name, import.meta.url), "utf8");
  const { configById } = JSON.parse(read("foxglove.json"));
  const topics = Object.keys(configById["3D!scene"].topics);
  const plots = Object.values(configById).flatMap(({ paths }) => (paths ?? []).map(({ value }) => value));
  for (const [, name] of read("plotjuggler.xml").matchAll(/<curve name="([^"]*)"/g))
    plots.push(name.replace(/^\/tick\//, "/tick."));
  return { topics, plots };
}

/** Counts the records of a file by their type, read as a stream. */
function countOf(bytes) {
  const reader = new McapStreamReader({ validateCrcs: true, decompressHandlers, includeChunks: false });
  const counts = {};
  for (let at = 0; at < bytes.length; at += 100_000) {
    reader.append(bytes.subarray(at, at + 100_000)); // as from a socket
    for (let record; (record = reader.nextRecord());) counts[record.type] = (counts[record.type] ?? 0) + 1;
  }
  assert.ok(reader.done(), "the stream ends with the file");
  return counts;
}

async function all(records) {
  const found = [];
  for await (const each of records) found.push(each);
  return found;
}

async function checkFile(file, { times = false } = {}) {
  const bytes = readFileSync(file);
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, length) => bytes.subarray(Number(offset), Number(offset + length)),
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const validateCrcs = true;
  const messages = await all(reader.readMessages({ validateCrcs }));
  const attachments = await all(reader.readAttachments({ validateCrcs }));
  const [metadata] = await all(reader.readMetadata());
  const { statistics, chunkIndexes, channelsById } = reader;
  const counts = countOf(bytes);
  assert.equal(counts.Message, messages.length, "as a stream and by index there are as many messages");
  assert.equal(counts.Attachment, attachments.length);
  assert.equal(Number(statistics.messageCount), messages.length);
  assert.equal(statistics.attachmentCount, attachments.length);
  assert.equal(statistics.chunkCount, chunkIndexes.length);
  assert.ok(chunkIndexes.every((c) => c.compression === "zstd" && c.messageIndexOffsets.size > 0));
  JSON.parse(metadata.metadata.get("settings"));
  const middle = (statistics.messageStartTime + statistics.messageEndTime) / 2n;
  const some = await all(reader.readMessages({ topics: ["/plan"], startTime: middle, validateCrcs }));
  assert.ok(some.length > 0 && some.every((m) => channelsById.get(m.channelId).topic === "/plan"));

  const topics = [...channelsById.values()].map((c) => c.topic);
  assert.equal(topics.includes("/wall_clock"), times);
  const checks = new Map();
  for (const [id, schema] of reader.schemasById) {
    assert.equal(schema.encoding, "jsonschema");
    const parsed = JSON.parse(decoder.decode(schema.data));
    checks.set(id, ajv.compile(parsed));
    const [maker, name] = schema.name.split(".");
    if (maker === "foxglove") assert.deepEqual(parsed, bare(schemas[name]), schema.name);
  }
  const layouts = shownByLayouts();
  assert.ok(layouts.topics.length >= 5 && layouts.plots.length > 10);
  for (const topic of layouts.topics) assert.ok(topics.includes(topic), topic);
  const estimates = ["slip_estimate", "grip_used", "friction_estimate", "delay_estimate"];
  for (const message of messages) {
    const { topic, schemaId, messageEncoding } = channelsById.get(message.channelId);
    assert.equal(messageEncoding, "json");
    const content = JSON.parse(decoder.decode(message.data));
    const check = checks.get(schemaId);
    assert.ok(check(content), `${topic}: ${JSON.stringify(check.errors)}`);
    if (topic !== "/tick") continue;
    for (const name of estimates) assert.equal(typeof content[name], "number", `/tick.${name}`);
    for (const path of layouts.plots) assert.ok(path.replace("/tick.", "") in content, path);
  }
  const found = `${messages.length} messages, ${topics.length} topics, ${attachments.length} attachments`;
  console.log(`ok    ${file.split("/").at(-1)}: ${bytes.length} bytes, ${found}`);
}

const files = process.argv.slice(3);
for (const file of files) await checkFile(file);
if (!files.length) {
  const folder = mkdtempSync(join(tmpdir(), "slalom-mcap-"));
  const record = (name, ...more) => {
    const file = join(folder, name);
    const drive = ["drive", "--course", "wren", "--obstacles", "2", "--seed", "3", "--record", file];
    execFileSync(program, [...drive, ...more], { stdio: ["ignore", "ignore", "inherit"] });
    return file;
  };
  const [first, second] = [record("first.mcap"), record("second.mcap")];
  await checkFile(first);
  await checkFile(record("timed.mcap", "--record-times"), { times: true });
  await checkFile(record("laps.mcap", "--laps", "2", "--method", "mppi"));
  assert.ok(readFileSync(first).equals(readFileSync(second)), "the same seed gives the same bytes");
  console.log("ok    the same seed recorded twice gives the same bytes");
  rmSync(folder, { recursive: true });
}
