// Watches a run of `isobath serve` with Foxglove's own client of its WebSocket protocol, in both sub-protocols: the
// channels of map, points, track, plan, image and log arrive, each message parses and is of the run's time.
// Usage: node watch.mjs PROGRAM WORK_FOLDER; prints what came; exits 1 where anything is wrong.
import { spawn } from "node:child_process";
import { mkdirSync } from "node:fs";
import { createInterface } from "node:readline";
import foxglove from "@foxglove/ws-protocol";
import WebSocket from "ws";
const { FoxgloveClient } = foxglove;

const kWanted = ["tf", "pose", "location", "points", "sonar", "occupancy", "obstacles", "plan", "track", "log"];
const kLimit_ms = 60_000;
const [program, work] = process.argv.slice(2);
const failures = [];

function watch(address, protocol) {
  return new Promise((resolve) => {
    const got = {}, schemas = {};
    let info, time = 0n;
    const socket = new WebSocket(address, [protocol]);
    const client = new FoxgloveClient({ ws: socket });
    const topics = new Map();
    const end = () => {
      clearTimeout(limit);
      client.close();
      resolve({ protocol: socket.protocol, name: info?.name, topics: got, schemas, time: String(time) });
    };
    const limit = setTimeout(end, kLimit_ms);
    client.on("serverInfo", (event) => (info = event));
    client.on("error", (error) => failures.push(`${protocol}: ${error}`));
    client.on("time", (event) => (time = event.timestamp));
    client.on("advertise", (channels) => {
      for (const channel of channels) {
        topics.set(client.subscribe(channel.id), channel.topic);
        schemas[channel.topic] = channel.schemaName;
        if (JSON.parse(channel.schema).type !== "object") failures.push(`${channel.topic}: its schema is no object`);
      }
    });
    client.on("message", ({ subscriptionId, timestamp, data }) => {
      const topic = topics.get(subscriptionId);
      const message = JSON.parse(new TextDecoder().decode(data));
      const stamp = message.timestamp ?? message.entities?.[0]?.timestamp;
      if (stamp && BigInt(stamp.sec) * 1_000_000_000n + BigInt(stamp.nsec) > timestamp + 1_000_000_000n)
        failures.push(`${topic}: later than its message`);
      got[topic] = (got[topic] ?? 0) + 1;
      if (kWanted.every((name) => got[`/foxglove/${name}`] > 0) && time > 0n) end();
    });
  });
}

mkdirSync(work, { recursive: true });
const server = spawn(program, ["serve", "--port", "0", "--speed", "8", "--out", "out", "--json"], { cwd: work, stdio: ["ignore", "pipe", "inherit"] });
const port = await new Promise((resolve) => {
  createInterface(server.stdout).on("line", (line) => {
    const found = line.match(/:(\d+)\/|"port":\s*(\d+)/);
    if (found) resolve(Number(found[1] ?? found[2]));
  });
});
const address = `ws://127.0.0.1:${port}/foxglove`;
const seen = [];
for (const protocol of ["foxglove.websocket.v1", "foxglove.sdk.v1"]) seen.push(await watch(address, protocol));
const refused = await new Promise((resolve) => {
  const foreign = new WebSocket(address, ["chat"]);
  foreign.on("error", () => resolve(true));
  foreign.on("open", () => resolve(false));
});
if (!refused) failures.push("another sub-protocol was accepted");
for (const one of seen) {
  for (const name of kWanted) if (!one.topics[`/foxglove/${name}`]) failures.push(`${one.protocol}: no /foxglove/${name}`);
  if (one.schemas["/foxglove/points"] !== "foxglove.PointCloud") failures.push("points are no PointCloud");
}
const ended = new Promise((resolve) => server.on("close", resolve));
server.kill("SIGINT");
await ended;
console.log(JSON.stringify({ seen, failures: [...new Set(failures)] }));
process.exit(failures.length > 0 ? 1 : 0);
