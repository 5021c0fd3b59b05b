// A mission is sailed with node-mavlink between Isobath and the autopilot: each frame of either side is decoded by it,
// its signature is checked, it is encoded and signed by it again, and passed on. So it has to understand and to trust all
// that we send, and its frames have to drive us.
// Usage: node sail.mjs PROGRAM SOURCE_FOLDER WORK_FOLDER; prints what passed; exits 1 where anything is wrong.
import { spawn } from "node:child_process";
import { createHash } from "node:crypto";
import { createSocket } from "node:dgram";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { PassThrough } from "node:stream";
import mavlink from "node-mavlink";

const { ardupilotmega, common, createMavLinkStream, MavLinkProtocolV2, minimal } = mavlink;
const kMessages = { ...minimal.REGISTRY, ...common.REGISTRY, ...ardupilotmega.REGISTRY };
const kSpeed = "2";
const kPassphrase = "a boat among buoys";
const kKey = createHash("sha256").update(kPassphrase).digest();

const [program, source, work] = process.argv.slice(2);
const failures = [];
const passed = { "to the autopilot": {}, "from the autopilot": {} };

/// Zeros at the end of a payload are not sent.
function trimmed(bytes) {
  let end = bytes.length;
  while (end > 1 && bytes[end - 1] === 0) --end;
  return bytes.subarray(0, end);
}

/// Bytes written to the returned stream leave through `send`, frame by frame, as node-mavlink writes them.
function relay(direction, send) {
  const bytes = new PassThrough();
  createMavLinkStream(bytes, { onCrcError: () => failures.push(`${direction}: a frame with a wrong checksum`) }).on(
    "data",
    (packet) => {
      const { msgid, sysid, compid, seq } = packet.header;
      const type = kMessages[msgid];
      if (!type) return failures.push(`${direction}: message ${msgid} is unknown`);
      if (!packet.signature?.matches(kKey)) return failures.push(`${direction}: ${type.MSG_NAME} is not signed by the key`);
      const writer = new MavLinkProtocolV2(sysid, compid, MavLinkProtocolV2.IFLAG_SIGNED);
      const plain = writer.serialize(packet.protocol.data(packet.payload, type), seq);
      const time = packet.signature.timestamp / 100 + MavLinkProtocolV2.SIGNATURE_START_TIME + 0.004;  // rounded down
      const frame = writer.sign(plain, packet.signature.linkId, kKey, time);
      const again = frame.subarray(10, 10 + frame[1]);
      const name = type.MSG_NAME;
      if (!trimmed(again).equals(trimmed(packet.payload))) failures.push(`${direction}: ${name} is not written as read`);
      passed[direction][name] = (passed[direction][name] ?? 0) + 1;
      send(frame);
    },
  );
  return bytes;
}

/// A process whose standard output is lines of JSON.
function start(...options) {
  const child = spawn(program, options, { cwd: work, stdio: ["ignore", "pipe", "inherit"] });
  const lines = [];
  const first = new Promise((resolve) => {
    createInterface(child.stdout).on("line", (line) => {
      lines.push(JSON.parse(line));
      resolve(lines[0]);
    });
  });
  return { child, lines, first, ended: new Promise((resolve) => child.on("close", resolve)) };
}

function shortScene() {
  const text = readFileSync(join(source, "scenarios/aboard.toml"), "utf8");
  const second = text.indexOf('[[mission_point]]\nname = "B"');
  return (text.slice(0, second) + text.slice(text.indexOf("# Where it goes")))
    .replace("../vehicles/", join(source, "vehicles") + "/")
    .replace("north = 68", "north = 24")
    .replace('preset = "ping360"\n', 'preset = "ping360"\nspurious_share = 0\nnoise_level = 4\n');  // the timing differs
}

mkdirSync(work, { recursive: true });
writeFileSync(join(work, "scene.toml"), shortScene());
writeFileSync(join(work, "passphrase.txt"), `${kPassphrase}\n`);
// On a machine that does much else, a thread that waits is no agent that hangs.
writeFileSync(join(work, "settings.toml"), "[executor]\nmissed_ticks = 100\n");

const devices = ["ping360", "ping1d"];
const standIn = start("stand-in", "scene.toml", "--json", "--speed", kSpeed, "--autopilot", "udp-server:0",
                      "--key-file", "passphrase.txt",
                      ...devices.flatMap((device) => ["--device", `${device}=udp-server:0`]));
const ports = JSON.stringify(await standIn.first);
const portOf = (name) => Number(ports.match(new RegExp(`"${name}":\\s*(\\d+)`))[1]);

const ours = createSocket("udp4"), autopilot = createSocket("udp4");
await new Promise((resolve) => ours.bind(0, "127.0.0.1", resolve));
let peer;
const outward = relay("to the autopilot", (frame) => autopilot.send(frame, portOf("autopilot"), "127.0.0.1"));
const inward = relay("from the autopilot", (frame) => peer && ours.send(frame, peer.port, peer.address));
ours.on("message", (bytes, from) => outward.write(bytes) && (peer = from));
autopilot.on("message", (bytes) => inward.write(bytes));

writeFileSync(join(work, "vehicle.toml"), `[autopilot]\nlink = "udp:127.0.0.1:${ours.address().port}"\nkey_file = "passphrase.txt"\n` +
  devices.map((device) => `[[device]]\nkind = "${device}"\nlink = "udp:127.0.0.1:${portOf(device)}"\n`).join(""));
const aboard = start("aboard", "vehicle.toml", "--json", "--speed", kSpeed, "--until-done", "--no-page", "--out", "out",
                     "--config", "settings.toml");
const limit = setTimeout(() => aboard.child.kill("SIGINT"), 100_000);
const code = await aboard.ended;
clearTimeout(limit);
standIn.child.kill("SIGINT");
await standIn.ended;
ours.close();
autopilot.close();

const end = standIn.lines.at(-1);
const check = (right, what) => right || failures.push(what);
check(code === 0, `aboard ended with ${code}`);
check(end.contact_s === -1, "the vehicle touched something");
check(end.length_m > 20, `the vehicle sailed ${end.length_m} m`);
check(end.untrusted === 0, `${end.untrusted} frames were not trusted`);
check(end.setpoints > 50, `${end.setpoints} set-points arrived`);
for (const name of ["HEARTBEAT", "SET_POSITION_TARGET_LOCAL_NED", "MISSION_REQUEST_INT", "OBSTACLE_DISTANCE"]) {
  check(passed["to the autopilot"][name] > 0, `no ${name} was sent`);
}
console.log(JSON.stringify({ passed, stand_in: end, failures: [...new Set(failures)] }));
process.exit(failures.length > 0 ? 1 : 0);
