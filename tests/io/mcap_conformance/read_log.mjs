// Reads Isobath logs with @mcap/core, by index and as a stream, checksums on; decodes every message by the schema in the file.
// Usage: node read_log.mjs [--expect EXPECTED.json] FILE.mcap ... ; prints one JSON line a file; exits 1 where anything is wrong.
import { readFileSync } from "node:fs";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import * as lz4Module from "@foxglove/wasm-lz4";
import * as zstdModule from "@foxglove/wasm-zstd";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";

const zstd = zstdModule.default ?? zstdModule;
const lz4 = lz4Module.default ?? lz4Module;

function assert(condition, what) {
  if (!condition) throw new Error(what);
}

function readableOf(bytes) {
  return {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => {
      const from = Number(offset), to = from + Number(size);
      assert(to <= bytes.length, "a read beyond the end of the file");
      return new Uint8Array(bytes.buffer, bytes.byteOffset + from, Number(size));
    },
  };
}

class Decoder {
  readers = new Map();
  counts = {};
  samples = 0;
  sum = 0;

  take(channel, schema, message) {
    assert(channel.messageEncoding === "cdr" && schema.encoding === "ros2msg", "an encoding that is not CDR by ros2msg");
    if (!this.readers.has(schema.id)) {
      const definition = parse(new TextDecoder().decode(schema.data), { ros2: true });
      this.readers.set(schema.id, new MessageReader(definition));
    }
    const decoded = this.readers.get(schema.id).readMessage(message.data);
    this.counts[channel.topic] = (this.counts[channel.topic] ?? 0) + 1;
    const pose = decoded.sensor ?? decoded.body;
    const norm = pose ? Math.hypot(pose.qx, pose.qy, pose.qz, pose.qw) : 1;
    assert(Math.abs(norm - 1) < 1e-9, "a quaternion that is no rotation");
    if (schema.name === "isobath/msg/Ping") this.takePing(decoded);
    if (schema.name === "isobath/msg/Swath") this.takeSwath(decoded);
    if (decoded.time_ns >= 0n) assert(decoded.time_ns === message.logTime, "times of message and container differ");
  }

  takeSwath(swath) {
    for (const list of [swath.x, swath.y, swath.z, swath.range, swath.sigma, swath.beam]) {
      assert(list.length === swath.kind.length, "not one number a sounding");
    }
  }

  takePing(ping) {
    const lists = [ping.samples_u8, ping.samples_u16, ping.samples_f32].filter((list) => list.length > 0);
    assert(lists.length === 1, "not one list of samples");
    assert(lists[0].length === ping.azimuth.length * ping.bins, "samples are not beams x bins");
    assert(ping.beam_width.length === ping.azimuth.length, "not one width a beam");
    for (const value of lists[0]) this.sum += value;
    this.samples += lists[0].length;
  }
}

async function readByIndex(bytes, decompressHandlers) {
  const reader = await McapIndexedReader.Initialize({ readable: readableOf(bytes), decompressHandlers });
  const decoder = new Decoder();
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    const channel = reader.channelsById.get(message.channelId);
    decoder.take(channel, reader.schemasById.get(channel.schemaId), message);
  }
  const total = Object.values(decoder.counts).reduce((a, b) => a + b, 0);
  assert(reader.statistics.messageCount === BigInt(total), "statistics miscount the messages");
  const metadata = [];
  for await (const item of reader.readMetadata()) metadata.push(item.name);
  return { decoder, metadata, chunks: reader.chunkIndexes.length };
}

function readAsStream(bytes, decompressHandlers) {
  const reader = new McapStreamReader({ validateCrcs: true, decompressHandlers });
  reader.append(bytes);
  const decoder = new Decoder(), channels = new Map(), schemas = new Map();
  for (let record = reader.nextRecord(); record; record = reader.nextRecord()) {
    if (record.type === "Schema") schemas.set(record.id, record);
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type !== "Message") continue;
    const channel = channels.get(record.channelId);
    decoder.take(channel, schemas.get(channel.schemaId), record);
  }
  assert(reader.done(), "the stream does not end with the file");
  return decoder;
}

if (zstd.isLoaded) await zstd.isLoaded;
if (lz4.isLoaded) await lz4.isLoaded;
const decompressHandlers = {
  zstd: (buffer, size) => zstd.decompress(buffer, Number(size)),
  lz4: (buffer, size) => lz4(buffer, Number(size)),
};
const args = process.argv.slice(2);
const expected = args[0] === "--expect" ? JSON.parse(readFileSync(args.splice(0, 2)[1], "utf8")) : undefined;
for (const file of args) {
  const bytes = readFileSync(file);
  const indexed = await readByIndex(bytes, decompressHandlers);
  const streamed = readAsStream(bytes, decompressHandlers);
  for (const [topic, count] of Object.entries(streamed.counts)) {
    assert(indexed.decoder.counts[topic] === count, "index and stream count differently");
  }
  const { counts, samples, sum } = streamed;
  console.log(JSON.stringify({ counts, samples, sum, chunks: indexed.chunks, metadata: indexed.metadata }));
  if (!expected) continue;
  for (const [topic, count] of Object.entries(expected.counts)) assert(counts[topic] === count, `${topic} was miscounted`);
  assert(samples === expected.samples && sum === expected.sum, "other samples than were written");
}
