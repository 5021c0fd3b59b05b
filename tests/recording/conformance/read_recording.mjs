// Reads Isobath recordings with @mcap/core, by index and as a stream, checksums on; every message of a foxglove schema must be
// valid by @foxglove/schemas, and that schema be the one in the file. Usage: node read_recording.mjs FOLDER, which holds
// whole.mcap, cut.mcap (the same, cut off) and expected.json ({"topic": messages}). Exits 1 where anything is wrong.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import * as foxglove from "@foxglove/schemas/jsonschema.js";
import * as zstdModule from "@foxglove/wasm-zstd";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import Ajv from "ajv";

const zstd = zstdModule.default ?? zstdModule;
if (zstd.isLoaded) await zstd.isLoaded;
const decompressHandlers = { zstd: (buffer, size) => zstd.decompress(buffer, Number(size)) };
const ajv = new Ajv({ strict: false, allErrors: true });
const published = foxglove.default ?? foxglove;

/** A schema without its prose. */
function bare(value) {
  if (Array.isArray(value)) return value.map(bare);
  if (value === null || typeof value !== "object") return value;
  const kept = Object.entries(value).filter(([key, of]) => key !== "$comment" && !(key === "description" && typeof of === "string"));
  return Object.fromEntries(kept.map(([key, of]) => [key, bare(of)]));
}

const validators = new Map();
function validatorOf(schema) {
  if (!validators.has(schema.name)) {
    const inFile = JSON.parse(new TextDecoder().decode(schema.data));
    if (schema.name.startsWith("foxglove.")) {
      const theirs = published[schema.name.slice("foxglove.".length)];
      assert.ok(theirs, `${schema.name} is not published`);
      assert.deepEqual(inFile, bare(theirs), `${schema.name} in the file is not the published one`);
      validators.set(schema.name, ajv.compile(theirs));
    } else {
      validators.set(schema.name, ajv.compile(inFile));
    }
  }
  return validators.get(schema.name);
}

/** Bytes of all elements must fill what strides and counts say. */
function checkPacked(topic, m) {
  const bytes = Buffer.from(m.data, "base64");
  if (m.point_stride !== undefined) assert.equal(bytes.length % m.point_stride, 0, topic);
  if (m.row_stride !== undefined) assert.equal(bytes.length % m.row_stride, 0, topic);
  if (m.encoding === "mono8") assert.equal(bytes.length, m.step * m.height, topic);
}

/** Records of a display fit into one another to the last byte. */
function checkDisplay(data) {
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  let at = 0;
  for (; at + 24 <= data.byteLength; ) {
    const kind = view.getUint8(at), payload = view.getUint32(at + 4, true);
    assert.ok(kind >= 1 && kind <= 14 && view.getUint16(at + 2, true) === 0, "no record of a display");
    at += 24 + Math.ceil(payload / 8) * 8;
  }
  assert.equal(at, data.byteLength, "a record of a display is cut off");
}

function check(channel, schema, message) {
  if (channel.messageEncoding === "isobath.display") checkDisplay(message.data);
  if (channel.messageEncoding !== "json") return;
  const value = JSON.parse(new TextDecoder().decode(message.data));
  const validate = validatorOf(schema);
  assert.ok(validate(value), `${channel.topic}: ${ajv.errorsText(validate.errors)}`);
  if (schema.name.startsWith("foxglove.") && typeof value.data === "string") checkPacked(channel.topic, value);
}

async function readByIndex(bytes) {
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => new Uint8Array(bytes.buffer, bytes.byteOffset + Number(offset), Number(size)),
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const counts = {};
  let last = 0n;
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    const channel = reader.channelsById.get(message.channelId);
    assert.ok(message.logTime >= last, "out of order");
    last = message.logTime;
    check(channel, reader.schemasById.get(channel.schemaId), message);
    counts[channel.topic] = (counts[channel.topic] ?? 0) + 1;
  }
  const names = [];
  for await (const attachment of reader.readAttachments({ validateCrcs: true })) names.push(attachment.name);
  assert.ok(names.includes("configuration.toml") && names.includes("mission.toml"), "attachments are missing");
  return counts;
}

function readAsStream(bytes, whole) {
  const reader = new McapStreamReader({ validateCrcs: true, decompressHandlers });
  reader.append(bytes);
  const counts = {}, channels = new Map(), schemas = new Map();
  for (let record = reader.nextRecord(); record; record = reader.nextRecord()) {
    if (record.type === "Schema") schemas.set(record.id, record);
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type !== "Message") continue;
    const channel = channels.get(record.channelId);
    check(channel, schemas.get(channel.schemaId), record);
    counts[channel.topic] = (counts[channel.topic] ?? 0) + 1;
  }
  assert.equal(reader.done(), whole, "where the stream ends");
  return counts;
}

const folder = process.argv[2];
const expected = JSON.parse(readFileSync(join(folder, "expected.json"), "utf8"));
const whole = readFileSync(join(folder, "whole.mcap"));
const counts = await readByIndex(whole);
assert.deepEqual(counts, readAsStream(whole, true), "index and stream count differently");
for (const [topic, count] of Object.entries(expected)) {
  if (count < 0) assert.ok(counts[topic] > 0, `nothing on ${topic}`);
  else assert.equal(counts[topic], count, topic);
}
const cut = readAsStream(readFileSync(join(folder, "cut.mcap")), false);
assert.ok(cut["/navigation"] > 0 && cut["/navigation"] < counts["/navigation"], "what is left of a recording that was cut off");
console.log(JSON.stringify(counts));
