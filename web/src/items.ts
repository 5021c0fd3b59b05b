/**
 * The JSON payloads as the page reads them. A key that is missing or of another type becomes its absent value, so that
 * an older or newer program costs a line on the page, never the page. Only a payload that is not JSON of the right
 * outer form is refused (null).
 */
import { all, counts, flag, isObject, list, number, outlines, point, point3, points, seconds, words } from './json';
import type { Point, Point3 } from './protocol';

export interface MissionPoint {
  name: string;
  task: string;
  at: Point;
  depth: number | undefined;
  altitude: number | undefined;
  /** m/s; absent: that of the mission. */
  speed: number | undefined;
  /** No leg leads to it from the point before. */
  apart: boolean;
}
export interface Scene {
  title: string;
  source: string;
  simulated: boolean;
  /** s since 1970 */
  start: number;
  origin: { latitude: number; longitude: number } | undefined;
  fence: Point[];
  keepOut: Point[][];
  land: Point[][];
  mission: MissionPoint[];
  /** Grows with each mission that replaces another during the run. */
  missionNumber: number;
  /** m/s */
  missionSpeed: number | undefined;
  bodies: { name: string; outline: Point[] }[];
  /** Outlines of the charted obstacles. */
  charted: Point[][];
  vehicle: { name: string; length: number; safe: number | undefined };
  /** The names of the vehicles that share the mission, and which of them this is; empty: it is alone. */
  group: string[];
  own: number;
  datum: string;
  /** Marks of the time line that a recording has before it is played. */
  marks: Mark[];
}
export interface Mark {
  /** s since the start */
  at: number;
  what: string;
  alarm: boolean;
}

export function readScene(json: unknown): Scene | null {
  if (!isObject(json)) return null;
  const origin = isObject(json.origin) ? json.origin : {};
  const [latitude, longitude] = [number(origin.latitude), number(origin.longitude)];
  const vehicle = isObject(json.vehicle) ? json.vehicle : {};
  return {
    title: words(json.title),
    source: words(json.source),
    simulated: flag(json.simulated),
    start: typeof json.start_ns === 'string' && /^-?\d{1,19}$/.test(json.start_ns) ? seconds(json.start_ns) : 0,
    origin: latitude === undefined || longitude === undefined ? undefined : { latitude, longitude },
    fence: points(json.fence),
    keepOut: outlines(json.keep_out),
    land: outlines(json.land),
    mission: all(json.mission, (v) => {
      const at = isObject(v) ? point(v.at) : undefined;
      if (!isObject(v) || !at) return undefined;
      return { name: words(v.name), task: words(v.task), at, depth: number(v.depth_m), altitude: number(v.altitude_m), speed: number(v.speed), apart: flag(v.apart) };
    }),
    missionNumber: number(json.mission_number) ?? 0,
    missionSpeed: number(json.mission_speed),
    charted: all(json.charted, (v) => {
      const [a, b] = isObject(v) ? [point(v.a), point(v.b)] : [];
      return isObject(v) && a && b ? around(a, b, Math.max(0.1, number(v.radius_m) ?? 0)) : undefined;
    }),
    bodies: all(json.bodies, (v) => (isObject(v) ? { name: words(v.name), outline: points(v.outline) } : undefined)),
    vehicle: {
      name: words(vehicle.name),
      length: Math.min(500, Math.max(0.1, number(vehicle.length_m) ?? 1.5)),
      safe: number(vehicle.safe_m),
    },
    group: isObject(json.group) ? list(json.group.vehicles).map(words) : [],
    own: (isObject(json.group) ? number(json.group.own) : undefined) ?? 0,
    datum: words(json.depth_datum),
    marks: all(json.marks, (v) => {
      const at = isObject(v) ? number(v.at_s) : undefined;
      return isObject(v) && at !== undefined ? { at, what: words(v.what), alarm: flag(v.alarm) } : undefined;
    }),
  };
}

/** Outline of the points within a radius of the line from a to b. */
function around([an, ae]: Point, [bn, be]: Point, radius: number): Point[] {
  const along = an === bn && ae === be ? 0 : Math.atan2(be - ae, bn - an);
  const kCorners = 8;
  const half = (n: number, e: number, from: number): Point[] =>
    Array.from({ length: kCorners + 1 }, (_, i) => {
      const angle = from + (Math.PI * i) / kCorners;
      return [n + radius * Math.cos(angle), e + radius * Math.sin(angle)];
    });
  return [...half(bn, be, along - Math.PI / 2), ...half(an, ae, along + Math.PI / 2)];
}

export interface Sonar {
  name: string;
  scanning: boolean;
  /** A vertical fan: its beams differ in elevation. */
  vertical: boolean;
  azimuth: Float32Array;
  width: Float32Array;
  height: number;
  first: number;
  bin: number;
  bins: number;
  scale: { unit: string; low: number; high: number };
}

export const kMostBeams = 4096;
export const kMostBins = 16384;

export function readSonar(json: unknown): Sonar | null {
  if (!isObject(json)) return null;
  const azimuth = all(json.azimuth, number);
  const bin = number(json.bin_m) ?? 0;
  const bins = number(json.bins) ?? 0;
  const fits = azimuth.length > 0 && azimuth.length <= kMostBeams && bin > 0 && bins >= 1 && bins <= kMostBins;
  if (!fits || !Number.isInteger(bins)) return null;
  const scale = isObject(json.scale) ? json.scale : {};
  const widths = all(json.width, number);
  return {
    name: words(json.name),
    scanning: flag(json.scanning),
    vertical: flag(json.upright),
    azimuth: Float32Array.from(azimuth),
    width: Float32Array.from(azimuth, (_, i) => widths[i] ?? widths[0] ?? number(json.width) ?? 0.02),
    height: number(json.height) ?? 0,
    first: number(json.first_m) ?? 0,
    bin,
    bins,
    scale: { unit: words(scale.unit), low: number(scale.low) ?? 0, high: number(scale.high) ?? 255 },
  };
}

/** An obstacle as people count it: all its pieces together. */
export interface Obstacle {
  /** From 1; it keeps its number from scan to scan. */
  number: number;
  /** "compact" (a pole, a buoy) or "extended" (a wall, a hull). */
  kind: string;
  /** m: largest distance between two corners of its outlines. */
  extent: number | undefined;
  existence: number | undefined;
  /** Whether the last scan shows it; else it is only remembered. */
  inScan: boolean;
  behind: boolean;
  /** When the agents first and last saw it, s since the start; absent if they do not remember it. */
  since: number | undefined;
  seen: number | undefined;
}
/** A convex piece of an obstacle: of the last scan, or remembered. */
export interface Piece {
  /** The number of its obstacle. */
  number: number | undefined;
  /** Identifies a remembered piece; a piece of the last scan has none. */
  id: number | undefined;
  /** For a piece of the last scan: the remembered piece that it was assigned to. */
  of: number | undefined;
  /** Empty for a remembered piece that the last scan has seen completely. */
  outline: Point[];
  existence: number | undefined;
  behind: boolean;
  /** The part of the water that its echoes come from, if known. */
  label: 'standing' | 'bottom' | 'surface' | undefined;
  /** m: how far a remembered piece may extend beyond its outline by now. */
  margin: number;
  /** When a remembered piece was first and last seen, s since the start. */
  since: number | undefined;
  seen: number | undefined;
  /** Earlier positions of its centre, oldest first. */
  trail: Point[];
  /** m/s north and east, of a body that is known to move. */
  velocity: Point | undefined;
  /** Of the position and of the velocity of such a body. */
  covariance: Covariance | undefined;
  velocityCovariance: Covariance | undefined;
}
/** North north, north east, east east; m² or (m/s)². */
export type Covariance = [number, number, number];
function covariance(v: unknown): Covariance | undefined {
  const [nn, ne, ee] = [number(list(v)[0]), number(list(v)[1]), number(list(v)[2])];
  return nn === undefined || ne === undefined || ee === undefined ? undefined : [nn, ne, ee];
}
export interface Obstacles {
  obstacles: Obstacle[];
  pieces: Piece[];
}
/** Recordings of older programs contain a list of pieces only. */
export function readObstacles(json: unknown): Obstacles | null {
  const pieces = isObject(json) ? json.pieces : json;
  if (!Array.isArray(pieces)) return null;
  return { obstacles: isObject(json) ? all(json.obstacles, readObstacle) : [], pieces: all(pieces, readPiece) };
}
function readObstacle(v: unknown): Obstacle | undefined {
  const own = isObject(v) ? number(v.number) : undefined;
  if (!isObject(v) || own === undefined) return undefined;
  return {
    number: own,
    kind: words(v.kind),
    extent: number(v.extent_m),
    existence: number(v.existence),
    inScan: flag(v.in_scan),
    behind: flag(v.behind),
    since: number(v.since_s),
    seen: number(v.seen_s),
  };
}
function readPiece(v: unknown): Piece | undefined {
  if (!isObject(v)) return undefined;
  return {
    number: number(v.number),
    id: number(v.id),
    of: number(v.of),
    outline: points(v.outline),
    existence: number(v.existence),
    behind: flag(v.behind),
    label: v.label === 'standing' || v.label === 'bottom' || v.label === 'surface' ? v.label : undefined,
    margin: Math.min(1000, Math.max(0, number(v.margin_m) ?? 0)),
    since: number(v.since_s),
    seen: number(v.seen_s),
    trail: points(v.trail),
    velocity: point(v.velocity),
    covariance: covariance(v.covariance_m2),
    velocityCovariance: covariance(v.velocity_covariance),
  };
}

export interface Way {
  version: number | undefined;
  points: Point3[];
  avoiding: boolean;
  why: string;
  phase: string;
  reached: number | undefined;
  dropped: number | undefined;
  target: number | undefined;
}
export function readWay(json: unknown): Way | null {
  if (!isObject(json)) return null;
  return {
    version: number(json.version),
    points: all(json.points, point3),
    avoiding: Array.isArray(json.avoiding) ? json.avoiding.length > 0 : Boolean(json.avoiding),
    why: words(json.why),
    phase: words(json.phase),
    reached: number(json.reached),
    dropped: number(json.dropped),
    target: number(json.target),
  };
}

export interface Decision {
  /** From 1, as the terminal, the report and decisions.json number it. */
  number: number;
  /** s since 1970 */
  time: number;
  agent: string;
  what: string;
  reason: string;
  obstacle: Point | undefined;
  /** The number of that obstacle, if it has one. */
  obstacleNumber: number | undefined;
  /** From 1. */
  leg: number | undefined;
  margin: number | undefined;
  /** The closest approach to that obstacle, if it moves: in s, the gap in m, and the obstacle's place then. */
  approach: { in: number; gap: number; body: Point | undefined } | undefined;
  way: Point[];
}
function readApproach(v: unknown): Decision['approach'] {
  const [within, gap] = isObject(v) ? [number(v.in_s), number(v.gap_m)] : [];
  if (!isObject(v) || within === undefined || gap === undefined) return undefined;
  return { in: within, gap, body: point(v.obstacle_m) };
}
export function readDecision(json: unknown, n: number, time: number): Decision | null {
  if (!isObject(json)) return null;
  return {
    number: n,
    time,
    agent: words(json.agent),
    what: words(json.what),
    reason: words(json.reason),
    obstacle: point(json.obstacle_m),
    obstacleNumber: number(json.obstacle),
    leg: number(json.leg),
    margin: number(json.margin_m),
    approach: readApproach(json.approach),
    way: points(json.way_m),
  };
}

export interface Fault {
  fault: string;
  why: string;
  action: string;
  active: boolean;
  since: number | undefined;
}
export interface StageTime {
  name: string;
  median: number;
  p99: number;
  worst: number;
  count: number;
}
export interface Health {
  counts: [string, number][];
  refused: [string, number][];
  alarms: string[];
  faults: Fault[];
  agents: { name: string; state: string; why: string }[];
  /** The least charge of the batteries, 0 to 1, and whether a part reports water; absent: no part tells. */
  battery: number | undefined;
  leak: boolean | undefined;
  /** All other values, listed as they are. */
  more: [string, string][];
}
const kNamedHealth = new Set(['counts', 'refused', 'alarms', 'faults', 'agents', 'parts']);

export function readHealth(json: unknown): Health | null {
  if (!isObject(json)) return null;
  const more: [string, string][] = [];
  for (const [key, value] of Object.entries(json)) {
    if (!kNamedHealth.has(key)) tell(key, value, more);
  }
  for (const part of list(json.parts)) {
    if (!isObject(part)) continue;
    const { name, ...says } = part;
    if (says.note === '') delete says.note;
    tell(words(name), says, more);
  }
  return {
    counts: counts(json.counts),
    refused: counts(json.refused),
    alarms: list(json.alarms)
      .map(words)
      .filter((alarm) => alarm !== ''),
    faults: all(json.faults, (v) =>
      isObject(v)
        ? {
            fault: words(v.fault),
            why: words(v.why),
            action: words(v.action),
            active: flag(v.active),
            since: number(v.since_s),
          }
        : undefined,
    ),
    agents: all(json.agents, (v) =>
      isObject(v) ? { name: words(v.name), state: words(v.state), why: words(v.why) } : undefined,
    ),
    ...powerOf(list(json.parts)),
    more,
  };
}

function powerOf(parts: unknown[]): Pick<Health, 'battery' | 'leak'> {
  const shares = all(parts, (part) => (isObject(part) ? number(part.battery_share) : undefined));
  const leaks = all(parts, (part) => (isObject(part) && typeof part.leak === 'boolean' ? part.leak : undefined));
  return {
    battery: shares.length > 0 ? Math.min(...shares) : undefined,
    leak: leaks.length > 0 ? leaks.includes(true) : undefined,
  };
}

export function readTimes(json: unknown): StageTime[] | null {
  if (!Array.isArray(json)) return null;
  return all(json, (v) =>
    isObject(v)
      ? {
          name: words(v.name),
          median: number(v.median_ms) ?? NaN,
          p99: number(v.p99_ms) ?? NaN,
          worst: number(v.worst_ms) ?? NaN,
          count: number(v.count) ?? 0,
        }
      : undefined,
  );
}

/** Flattens to lines such as "depth pixels: 4100"; a unit in the name is put after the value. */
function tell(name: string, value: unknown, lines: [string, string][]): void {
  if (isObject(value)) {
    for (const [key, inner] of Object.entries(value)) tell(`${name} ${key}`, inner, lines);
  } else if (typeof value === 'number') {
    const [, plain = name, unit = ''] = /^(.*?)(?:_(m|s|ms|v|share|deg))?$/.exec(name) ?? [];
    const shown = Number.isInteger(value) ? value.toLocaleString('en-GB') : value.toPrecision(4);
    const text = unit === 'share' ? `${(value * 100).toFixed(0)} %` : `${shown} ${unit === 'v' ? 'V' : unit}`.trim();
    lines.push([plain.replaceAll('_', ' '), text]);
  } else if (typeof value === 'string' || typeof value === 'boolean') {
    lines.push([name.replaceAll('_', ' '), value === true ? 'yes' : value === false ? 'no' : value]);
  }
}

export interface Clock {
  now: number;
  start: number;
  end: number;
  live: boolean;
  /** Whether there is a live view to go back to; a recording has none. */
  hasNow: boolean;
  /** The present of the run, s since its start. */
  present: number | undefined;
  /** The run has ended: the live view stands still. */
  over: boolean;
  playing: boolean;
  speed: number;
  /** Whether this page may command; absent if the program takes no commands. */
  control: boolean | undefined;
  /** Whether a page with command may plan missions. */
  plans: boolean;
  /** Which page has command, and since when, s after the start; absent: none. */
  command: { by: string; since: number } | undefined;
  version: string;
  /** Differs from that of any other run; empty: unknown. */
  run: string;
  /** Number of the frame; absent: the feed does not tell its delay. */
  frame: number | undefined;
  /** s of the program's clock: all that an operator acts on, and all samples and maps, are complete up to then. */
  made: number | undefined;
  maps: number | undefined;
  /** The last frame whose answer came, and when it came. */
  seen: number;
  seenAt: number;
}
export function readClock(json: unknown): Clock | null {
  if (!isObject(json)) return null;
  const now = number(json.now_s);
  if (now === undefined) return null;
  return {
    now,
    start: number(json.start_s) ?? 0,
    end: number(json.end_s) ?? now,
    live: flag(json.live),
    hasNow: flag(json.live) || number(json.live_s) !== undefined,
    present: number(json.live_s),
    over: flag(json.over),
    playing: flag(json.playing),
    speed: number(json.speed) ?? 1,
    control: typeof json.control === 'boolean' ? json.control : undefined,
    plans: flag(json.plans),
    command: isObject(json.command) ? { by: words(json.command.by), since: number(json.command.since_s) ?? 0 } : undefined,
    version: typeof json.version === 'number' ? String(json.version) : words(json.version),
    run: words(json.run),
    frame: number(json.frame),
    made: number(json.made_s),
    maps: number(json.maps_s),
    seen: number(json.seen) ?? -1,
    seenAt: number(json.seen_s) ?? NaN,
  };
}

export interface Refusal {
  request: string;
  why: string;
}
export function readRefusal(json: unknown): Refusal | null {
  if (!isObject(json)) return null;
  const request = isObject(json.request) ? words(json.request.ask) : words(json.request);
  return { request, why: words(json.why) };
}
