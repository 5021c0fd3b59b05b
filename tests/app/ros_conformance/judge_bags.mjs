// Reads the logs of ROS that `isobath convert` writes with readers of others, and has `isobath run` read logs that writers of others
// wrote, in all three families: ROS 1 and ROS 2 messages in MCAP (@mcap/core), and a database of rosbag2 (sql.js).
// Usage: node judge_bags.mjs FOLDER PROGRAM; exits 1 where anything is wrong.
import { execFileSync } from "node:child_process";
import { mkdirSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { md5, parse } from "@foxglove/rosmsg";
import * as serialization1 from "@foxglove/rosmsg-serialization";
import * as serialization2 from "@foxglove/rosmsg2-serialization";
import { McapIndexedReader, McapWriter } from "@mcap/core";

const require = createRequire(import.meta.url);
const { Bag } = require("@foxglove/rosbag");
const { FileReader } = require("@foxglove/rosbag/node");
const initSqlJs = require("sql.js");
const lz4 = require("@foxglove/wasm-lz4");
const zstd = require("@foxglove/wasm-zstd");

const [folder, program] = process.argv.slice(2);
const at = (name) => join(folder, name);

function assert(condition, what) {
  if (!condition) throw new Error(what);
}

function isobath(...words) {
  return execFileSync(program, words, { encoding: "utf8", stdio: ["ignore", "pipe", "inherit"] });
}

const kScene = `[scene]
title = "pile"
duration_s = 8
latitude_deg = 60.1
longitude_deg = 10.2
[vehicle]
start = [0, 0, 5]
speed = 0.5
[[waypoint]]
north = 18
east = 3
depth = 5
[bottom]
kind = "terrain"
material = "sand"
depth = 12
extent_m = 80
cell_m = 2
relief_m = 0.4
[[cylinder]]
name = "pile"
centre = [12, 2, 5]
radius = 0.4
length = 14
[navigation]
kind = "sensors"
[[sonar]]
preset = "p450_horizontal"
range_m = 20
bins = 240
interval_s = 0.5
[[sonar]]
preset = "altimeter"
`;

const kText = { ros1: {}, ros2: { ros2: true } };

/// Decodes and encodes the messages of a topic by its definition.
class Topic {
  constructor(family, name, type, text) {
    Object.assign(this, { family, name, type, text, messages: [] });
    this.definition = parse(text, kText[family]);
    const { MessageReader, MessageWriter } = family === "ros1" ? serialization1 : serialization2;
    this.reader = new MessageReader(this.definition);
    this.writer = new MessageWriter(this.definition);
  }
  take(time, data) {
    const message = this.reader.readMessage(data);
    this.messages.push({ time, data: Uint8Array.from(data), message });
  }
}

async function readBag(file) {
  const topics = new Map();
  const bag = new Bag(new FileReader(file), { parse: false, decompress: { lz4: (bytes, size) => lz4(bytes, size) } });
  await bag.open();
  for (const c of bag.connections.values()) {
    const topic = new Topic("ros1", c.topic, c.type, c.messageDefinition);
    // @foxglove/rosmsg takes "byte" for another name of int8, also in the text that ROS makes the md5 of.
    const has_byte = /^byte /m.test(c.messageDefinition);
    assert(has_byte || c.md5sum === md5(topic.definition), `${c.type} has another md5 than its definition`);
    topics.set(c.topic, topic);
  }
  for await (const m of bag.messageIterator()) {
    topics.get(m.topic).take(BigInt(m.timestamp.sec) * 1000000000n + BigInt(m.timestamp.nsec), m.data);
  }
  return topics;
}

async function readMcap(file, family) {
  const bytes = readFileSync(file), topics = new Map();
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => new Uint8Array(bytes.buffer, bytes.byteOffset + Number(offset), Number(size)),
  };
  const decompressHandlers = { zstd: (buffer, size) => zstd.decompress(buffer, Number(size)) };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  assert(reader.header.profile === family, "another profile than " + family);
  for await (const m of reader.readMessages({ validateCrcs: true })) {
    const channel = reader.channelsById.get(m.channelId), schema = reader.schemasById.get(channel.schemaId);
    assert(channel.messageEncoding === "cdr" && schema.encoding === "ros2msg", "not CDR by ros2msg");
    if (!topics.has(channel.topic)) {
      topics.set(channel.topic, new Topic(family, channel.topic, schema.name, new TextDecoder().decode(schema.data)));
    }
    topics.get(channel.topic).take(m.logTime, m.data);
  }
  return topics;
}

function rows(database, sql) {
  const found = database.exec(sql, undefined, { useBigInt: true })[0];
  return found ? found.values : [];
}

function readDatabase(sql, file) {
  const database = new sql.Database(readFileSync(file)), topics = new Map(), byId = new Map();
  for (const [id, name, type, format, text] of rows(
    database,
    "SELECT t.id, t.name, t.type, t.serialization_format, d.encoded_message_definition FROM topics t JOIN message_definitions d ON d.topic_type = t.type",
  )) {
    assert(format === "cdr", "a format that is not CDR");
    topics.set(name, new Topic("ros2", name, type, text));
    byId.set(id, topics.get(name));
  }
  for (const [id, time, data] of rows(database, "SELECT topic_id, timestamp, data FROM messages ORDER BY timestamp, id")) {
    byId.get(id).take(time, data);
  }
  return topics;
}

const ns = (stamp) => BigInt(stamp.sec) * 1000000000n + BigInt(stamp.nsec ?? stamp.nanosec);

/// A message without what ROS 1 and ROS 2 state differently.
function plain(message) {
  return JSON.stringify(message, (key, value) => {
    if (typeof value === "bigint") return value.toString();
    if (ArrayBuffer.isView(value)) return [...value].map((x) => (typeof x === "bigint" ? x.toString() : x));
    if (value && typeof value === "object" && "frame_id" in value) return { at: ns(value.stamp).toString(), frame_id: value.frame_id };
    return value;
  });
}

/// The same topics with the same messages, in all three files.
function compare(one, two, what) {
  assert([...one.keys()].sort().join() === [...two.keys()].sort().join(), `${what}: other topics`);
  for (const [name, topic] of one) {
    const other = two.get(name);
    assert(topic.messages.length === other.messages.length, `${what}: ${name} has another number of messages`);
    topic.messages.forEach((m, i) => {
      assert(m.time === other.messages[i].time, `${what}: ${name} has another time`);
      assert(plain(m.message) === plain(other.messages[i].message), `${what}: ${name} has another message`);
    });
  }
}

/// What the messages state, in the axes of ROS.
function judge(topics) {
  const poses = topics.get("/odometry").messages.map((m) => m.message), images = topics.get("/sonar/image").messages;
  assert(images.length >= 16 && poses.length > 20, "too few messages");
  const last = poses.at(-1).pose.pose;
  assert(poses[0].header.frame_id === "map" && poses[0].child_frame_id === "base_link", "other frames");
  assert(Math.abs(last.position.z + 5) < 1, "the vehicle is 5 m below the surface, so that z up is -5");
  assert(last.position.y > 1.5 && Math.abs(last.position.x) < last.position.y, "it sails north, which is y");
  const yaw = 2 * Math.atan2(last.orientation.z, last.orientation.w) * 180 / Math.PI;
  assert(yaw > 60 && yaw < 100, `heading a little east of north is a yaw below 90 degrees, not ${yaw}`);
  for (const { message: m, time } of images) {
    assert(time - ns(m.header.stamp) < 1000000n, "header and container state other times");
    assert(m.image.data.length === m.ranges.length * m.beam_directions.length, "samples are not beams x ranges");
    assert(m.beam_directions[0].y < 0 && m.beam_directions.at(-1).y > 0, "the first beam is to port: y is starboard");
  }
  const mounted = topics.get("/tf_static").messages.at(-1).message.transforms.map((t) => t.child_frame_id);
  assert(mounted.includes("sonar") && mounted.includes("range"), "not every sensor is mounted");
  assert(topics.get("/fix").messages[0].message.latitude.toFixed(3) === "60.100", "another place");
}

/// The topics, every message decoded and encoded again by the writer of others.
const rewritten = (topics, records) => [...topics.values()].filter((t) => records || !t.name.startsWith("/isobath/"));
function inOrder(topics) {
  const all = topics.flatMap((topic) => topic.messages.map((m, i) => ({ topic, time: m.time, message: m.message })));
  return all.sort((a, b) => (a.time < b.time ? -1 : a.time > b.time ? 1 : 0));
}

async function writeMcap(file, topics, family) {
  const parts = [];
  let size = 0n;
  const writable = { position: () => size, write: async (bytes) => { parts.push(Uint8Array.from(bytes)); size += BigInt(bytes.length); } };
  const writer = new McapWriter({ writable });
  await writer.start({ profile: family, library: "judge" });
  const channels = new Map();
  for (const topic of topics) {
    const schemaId = await writer.registerSchema({ name: topic.type, encoding: family + "msg", data: new TextEncoder().encode(topic.text) });
    const messageEncoding = family === "ros1" ? "ros1" : "cdr";
    channels.set(topic, await writer.registerChannel({ topic: topic.name, schemaId, messageEncoding, metadata: new Map() }));
  }
  let sequence = 0;
  for (const { topic, time, message } of inOrder(topics)) {
    const data = Uint8Array.from(topic.writer.writeMessage(message));
    await writer.addMessage({ channelId: channels.get(topic), sequence: sequence++, logTime: time, publishTime: time, data });
  }
  await writer.end();
  writeFileSync(file, Buffer.concat(parts));
}

/// As rosbag2 of Humble writes it: without definitions.
function writeDatabase(sql, file, topics) {
  const database = new sql.Database();
  database.run("CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL)");
  database.run("CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL, data BLOB NOT NULL)");
  topics.forEach((t, i) => database.run("INSERT INTO topics VALUES(?,?,?,'cdr','')", [i + 1, t.name, t.type]));
  const insert = database.prepare("INSERT INTO messages(topic_id,timestamp,data) VALUES(?,?,?)");
  for (const { topic, time, message } of inOrder(topics)) {
    insert.run([topics.indexOf(topic) + 1, time, Uint8Array.from(topic.writer.writeMessage(message))]);
  }
  writeFileSync(file, database.export());
}

function filesOf(at, below = "") {
  return readdirSync(join(at, below)).flatMap((name) => {
    const path = join(below, name);
    return statSync(join(at, path)).isDirectory() ? filesOf(at, path) : [path];
  });
}

/// Every result of a run but those that name the file that was read: manifest, report, and the titles of pictures.
function resultsOf(log) {
  const out = log + ".out";
  isobath("run", log, "--out", out, "--json");
  const results = new Map();
  for (const file of filesOf(out).sort()) {
    if (file !== "manifest.json" && !/\.(html|png)$/.test(file)) results.set(file, readFileSync(join(out, file)));
  }
  return results;
}

function sameMap(expected, log) {
  const found = resultsOf(log);
  assert([...expected.keys()].join() === [...found.keys()].join(), `${log}: other files of results`);
  assert(found.has("depth.tif"), `${log}: no depth map`);
  for (const [name, bytes] of expected) assert(bytes.equals(found.get(name)), `${log}: ${name} is not that of the native log`);
}

await lz4.isLoaded;
await zstd.isLoaded;
const sql = await initSqlJs();
rmSync(folder, { recursive: true, force: true });
mkdirSync(folder, { recursive: true });
writeFileSync(at("dive.toml"), kScene);
isobath("sim", at("dive.toml"), "--out", at("dive.mcap"));
isobath("convert", at("dive.mcap"), at("ours.bag"));
isobath("convert", at("dive.mcap"), at("ours.db3"));
isobath("convert", at("dive.mcap"), at("ours-ros2.mcap"), "--schema", "ros2");

const bag = await readBag(at("ours.bag")), mcap = await readMcap(at("ours-ros2.mcap"), "ros2"), database = readDatabase(sql, at("ours.db3"));
compare(mcap, database, "MCAP and SQLite");
compare(bag, mcap, "ROS 1 and ROS 2");
judge(bag);
console.log(`${bag.size} topics, ${inOrder([...bag.values()]).length} messages, the same in three files`);

const expected = resultsOf(at("dive.mcap"));
for (const records of [true, false]) {
  const name = records ? "with-records" : "ros-only";
  await writeMcap(at(`${name}-ros1.mcap`), rewritten(bag, records), "ros1");
  await writeMcap(at(`${name}-ros2.mcap`), rewritten(mcap, records), "ros2");
  writeDatabase(sql, at(`${name}.db3`), rewritten(database, records));
  for (const log of [`${name}-ros1.mcap`, `${name}-ros2.mcap`, `${name}.db3`].map(at)) {
    let native = expected;
    if (!records) {
      isobath("convert", log, log + ".native.mcap");
      native = resultsOf(log + ".native.mcap");
    }
    sameMap(native, log);
    console.log(`${log.slice(folder.length + 1)}: the map of the native log, ${native.size} files byte for byte`);
  }
}
