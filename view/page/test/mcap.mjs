// Reads recordings with other people's programs: node test/mcap.mjs PROGRAM [FILE.mcap]...
// Without files it records a lap first, twice, and once with times.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, openSync, readFileSync, readSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { loadDecompressHandlers } from "@mcap/support";
import schemas from "@foxglove/schemas/jsonschema.js";

const program = process.argv[2];
const decompressHandlers = await loadDecompressHandlers();

/** The demands of a schema, without its explanations. */
function bare(schema) {
  if (Array.isArray(schema)) return schema.map(bare);
  if (schema === null || typeof schema !== "object") return schema;
  return Object.fromEntries(
    Object.entries(schema)
      .filter(
        ([key, value]) => !(["title", "description", "$comment"].includes(key) && typeof value === "string"),
      )
      .map(([key, value]) => [key, bare(value)]),
  );
}

/** Whether a value is what a schema demands; only what the schemas of recordings use. */
function fits(value, schema, at) {
  if (schema.oneOf)
    return assert.ok(
      schema.oneOf.some((s) => s.const === value),
      `${at}: ${value} is not one of the choices`,
    );
  const types = [].concat(schema.type ?? []);
  const is = {
    object: (v) => v !== null && typeof v === "object" && !Array.isArray(v),
    array: Array.isArray,
    number: (v) => typeof v === "number",
    integer: Number.isInteger,
    string: (v) => typeof v === "string",
    boolean: (v) => typeof v === "boolean",
    null: (v) => v === null,
  };
  assert.ok(
    types.some((t) => is[t](value)),
    `${at}: ${JSON.stringify(value)?.slice(0, 60)} is not of type ${types}`,
  );
  if (schema.minimum !== undefined) assert.ok(value >= schema.minimum, at);
  if (schema.maximum !== undefined) assert.ok(value <= schema.maximum, at);
  if (schema.contentEncoding === "base64") assert.match(value, /^[A-Za-z0-9+/]*={0,2}$/, at);
  for (const name of schema.required ?? []) assert.ok(name in value, `${at}.${name} is missing`);
  for (const [name, inner] of Object.entries(schema.properties ?? {}))
    if (value && name in value) fits(value[name], inner, `${at}.${name}`);
  if (schema.items) value.forEach((v, i) => fits(v, schema.items, `${at}[${i}]`));
}

function readAsStream(bytes) {
  const reader = new McapStreamReader({ validateCrcs: true, decompressHandlers, includeChunks: false });
  const found = { schemas: new Map(), channels: new Map(), messages: [], attachments: [], metadata: [] };
  const take = () => {
    for (let record; (record = reader.nextRecord());) {
      if (record.type === "Schema") found.schemas.set(record.id, record);
      else if (record.type === "Channel") found.channels.set(record.id, record);
      else if (record.type === "Message") found.messages.push(record);
      else if (record.type === "Attachment") found.attachments.push(record);
      else if (record.type === "Metadata") found.metadata.push(record);
    }
  };
  for (let at = 0; at < bytes.length; at += 100_000) {
    reader.append(bytes.subarray(at, at + 100_000));
    take();
  } // as from a socket
  assert.ok(reader.done(), "the stream ends with the file");
  assert.equal(reader.bytesRemaining(), 0);
  return found;
}

async function readByIndex(file) {
  const descriptor = openSync(file),
    size = statSync(file).size;
  const readable = {
    size: async () => BigInt(size),
    read: async (offset, length) => {
      const to = new Uint8Array(Number(length));
      assert.equal(readSync(descriptor, to, 0, to.length, Number(offset)), to.length);
      return to;
    },
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const messages = [];
  for await (const message of reader.readMessages({ validateCrcs: true })) messages.push(message);
  const some = [];
  const middle = (reader.statistics.messageStartTime + reader.statistics.messageEndTime) / 2n;
  for await (const message of reader.readMessages({
    topics: ["/plan"],
    startTime: middle,
    validateCrcs: true,
  }))
    some.push(message);
  const attachments = [],
    metadata = [];
  for await (const each of reader.readAttachments({ validateCrcs: true })) attachments.push(each);
  for await (const each of reader.readMetadata()) metadata.push(each);
  return { reader, messages, some, attachments, metadata };
}

async function check(file, { times = false } = {}) {
  const stream = readAsStream(readFileSync(file)),
    { reader, messages, some, attachments, metadata } = await readByIndex(file);
  const statistics = reader.statistics;
  assert.equal(Number(statistics.messageCount), messages.length);
  assert.equal(
    stream.messages.length,
    messages.length,
    "as a stream and by index there are as many messages",
  );
  for (const [id, count] of statistics.channelMessageCounts)
    assert.equal(Number(count), stream.messages.filter((m) => m.channelId === id).length);
  assert.equal(reader.chunkIndexes.length, statistics.chunkCount);
  assert.ok(reader.chunkIndexes.every((c) => c.compression === "zstd" && c.messageIndexOffsets.size > 0));
  assert.equal(attachments.length, statistics.attachmentCount);
  assert.equal(stream.attachments.length, attachments.length);
  assert.equal(metadata.length, 1);
  JSON.parse(metadata[0].metadata.get("settings"));
  assert.ok(some.length > 0 && some.every((m) => reader.channelsById.get(m.channelId).topic === "/plan"));

  const topics = [...reader.channelsById.values()].map((c) => c.topic);
  assert.equal(topics.includes("/wall_clock"), times);
  for (const schema of reader.schemasById.values()) {
    assert.equal(schema.encoding, "jsonschema");
    const ours = JSON.parse(new TextDecoder().decode(schema.data)),
      [maker, name] = schema.name.split(".");
    if (maker === "foxglove") assert.deepEqual(ours, bare(schemas[name]), schema.name);
    schema.parsed = ours;
  }
  const decoder = new TextDecoder();
  const estimates = [
    "slip_estimate",
    "grip_used",
    "friction_estimate",
    "friction_relied_on",
    "steering_gain_estimate",
    "delay_estimate",
  ];
  for (const message of messages) {
    const channel = reader.channelsById.get(message.channelId);
    assert.equal(channel.messageEncoding, "json");
    const content = JSON.parse(decoder.decode(message.data));
    fits(content, reader.schemasById.get(channel.schemaId).parsed, channel.topic);
    if (channel.topic === "/tick")
      for (const name of estimates) assert.equal(typeof content[name], "number", `/tick.${name}`);
  }
  const counts = `${messages.length} messages, ${topics.length} topics, ${attachments.length} attachments`;
  console.log(`ok    ${file.split("/").at(-1)}: ${statSync(file).size} bytes, ${counts}`);
}

let files = process.argv.slice(3);
if (files.length) for (const file of files) await check(file);
else {
  const folder = mkdtempSync(join(tmpdir(), "slalom-mcap-"));
  const record = (name, ...more) => {
    const file = join(folder, name);
    execFileSync(
      program,
      ["drive", "--course", "wren", "--obstacles", "2", "--seed", "3", "--record", file, ...more],
      { stdio: ["ignore", "ignore", "inherit"] },
    );
    return file;
  };
  const first = record("first.mcap"),
    second = record("second.mcap"),
    timed = record("timed.mcap", "--record-times"),
    laps = record("laps.mcap", "--laps", "2", "--method", "mppi");
  await check(first);
  await check(timed, { times: true });
  await check(laps);
  assert.ok(
    readFileSync(first).equals(readFileSync(second)),
    "the same seed recorded twice gives the same bytes",
  );
  console.log("ok    the same seed recorded twice gives the same bytes");
  rmSync(folder, { recursive: true });
}
