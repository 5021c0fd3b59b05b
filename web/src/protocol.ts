/**
 * The wire protocol of docs/live-page.md: parses records and the payload of each kind.
 *
 * The bytes are untrusted, so every length is checked before use. A malformed payload gives null; the model counts it
 * and goes on. A record with a malformed head ends the message, because the start of the next record is unknown.
 * Numbers are copied out of the message only if the model keeps them longer than the message.
 */
import { unpackBits } from './packbits';

export const Kind = {
  scene: 1,
  vehicle: 2,
  track: 3,
  sonar: 4,
  echoes: 5,
  grid: 6,
  obstacles: 7,
  way: 8,
  decision: 9,
  depth: 10,
  voxels: 11,
  health: 12,
  clock: 13,
  refusal: 14,
  times: 15,
  cubes: 16,
  sphere: 17,
  sounds: 18,
  levels: 19,
  partner: 20,
  packed: 21,
  preview: 22,
  signals: 23,
} as const;
export type Kind = (typeof Kind)[keyof typeof Kind];
export const kLastKind = Kind.signals;

export const kHead = 24;
const kGone = 1;
const kForget = 2;
const kForgetKind = 4;

export interface RecordView {
  kind: Kind;
  gone: boolean;
  /** Forget all items before this one is applied. */
  forget: boolean;
  /** Forget all items of this kind before it. */
  forgetKind: boolean;
  /** The number of the item, as two halves; a BigInt would be slow for a thousand records a second. */
  high: number;
  low: number;
  /** Time of the content, s since 1970; accurate to a microsecond. */
  time: number;
  payload: DataView;
}

export const padded = (bytes: number): number => Math.ceil(bytes / 8) * 8;

/** Calls `take` for each complete record. Returns the number of bytes in records; fewer than all: damage. */
export function readRecords(bytes: Uint8Array, take: (record: RecordView) => void): number {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  let at = 0;
  while (bytes.length - at >= kHead) {
    const kind = view.getUint8(at);
    const flags = view.getUint8(at + 1);
    const size = view.getUint32(at + 4, true);
    const end = at + kHead + padded(size);
    if (kind < 1 || kind > kLastKind || view.getUint16(at + 2, true) !== 0 || end > bytes.length) return at;
    take({
      kind: kind as Kind,
      gone: (flags & kGone) !== 0,
      forget: (flags & kForget) !== 0,
      forgetKind: (flags & kForgetKind) !== 0,
      low: view.getUint32(at + 8, true),
      high: view.getUint32(at + 12, true),
      time: view.getInt32(at + 20, true) * 4.294967296 + view.getUint32(at + 16, true) / 1e9,
      payload: new DataView(bytes.buffer, bytes.byteOffset + at + kHead, size),
    });
    at = end;
  }
  return at;
}

export type Point = readonly [number, number];
export type Point3 = readonly [number, number, number];

const text = new TextDecoder('utf-8');

export function readJson(payload: DataView): unknown {
  try {
    return JSON.parse(text.decode(new Uint8Array(payload.buffer, payload.byteOffset, payload.byteLength)));
  } catch {
    return null;
  }
}

export interface Vehicle {
  north: number;
  east: number;
  down: number;
  roll: number;
  pitch: number;
  heading: number;
  surge: number;
  sway: number;
  heave: number;
  sigma: number;
  /** NaN: unknown. The three set-points below are NaN if there is none. */
  altitude: number;
  wantedHeading: number;
  wantedDepth: number;
  wantedSpeed: number;
}

export function readVehicle(p: DataView): Vehicle | null {
  if (p.byteLength < 72) return null;
  const f = (i: number) => p.getFloat32(24 + 4 * i, true);
  const vehicle = {
    north: p.getFloat64(0, true),
    east: p.getFloat64(8, true),
    down: p.getFloat64(16, true),
    roll: f(0),
    pitch: f(1),
    heading: f(2),
    surge: f(3),
    sway: f(4),
    heave: f(5),
    sigma: f(6),
    altitude: f(7),
    wantedHeading: f(8),
    wantedDepth: f(9),
    wantedSpeed: f(10),
  };
  const { north, east, down, roll, pitch, heading } = vehicle;
  return [north, east, down, roll, pitch, heading].every(Number.isFinite) ? vehicle : null;
}

/** Four numbers a position: seconds since the start, north, east, down. */
export function readTrack(p: DataView): Float32Array | null {
  if (p.byteLength % 16 !== 0 || p.byteLength > 64 * 16) return null;
  return floats(p, 0, p.byteLength / 4);
}

export interface Echoes {
  first: number;
  beams: number;
  bins: number;
  place: Point3;
  /** Rotation of the sensor to W, w x y z. */
  rotation: readonly [number, number, number, number];
  intensity: Uint8Array;
  decided: Uint8Array;
}

export function readEchoes(p: DataView, first: number): Echoes | null {
  if (p.byteLength < 48) return null;
  const beams = p.getUint16(0, true);
  const bins = p.getUint16(2, true);
  // On a slow link a sample stands for several beams and bins.
  const beamsEach = p.getUint8(4) || 1;
  const binsEach = p.getUint8(5) || 1;
  const columns = Math.ceil(bins / binsEach);
  const samples = Math.ceil(beams / beamsEach) * columns;
  const bits = padded(48 + samples);
  if (samples === 0 || p.byteLength < bits + Math.ceil(samples / 8)) return null;
  const f = (i: number) => p.getFloat32(32 + 4 * i, true);
  const place: Point3 = [p.getFloat64(8, true), p.getFloat64(16, true), p.getFloat64(24, true)];
  const rotation = [f(0), f(1), f(2), f(3)] as const;
  if (![...place, ...rotation].every(Number.isFinite)) return null;
  const intensity = new Uint8Array(p.buffer, p.byteOffset + 48, samples);
  const decided = new Uint8Array(p.buffer, p.byteOffset + bits, Math.ceil(samples / 8));
  const whole = { first, beams, bins, place, rotation };
  if (beamsEach === 1 && binsEach === 1) return { ...whole, intensity, decided };
  const all = new Uint8Array(beams * bins);
  const hits = new Uint8Array(Math.ceil(all.length / 8));
  for (let i = 0; i < all.length; ++i) {
    const from = Math.floor(Math.floor(i / bins) / beamsEach) * columns + Math.floor((i % bins) / binsEach);
    all[i] = intensity[from]!;
    hits[i >> 3]! |= ((decided[from >> 3]! >> (from & 7)) & 1) << (i & 7);
  }
  return { ...whole, intensity: all, decided: hits };
}

export interface Grid {
  nx: number;
  ny: number;
  cell: number;
  north: number;
  east: number;
  /** Heading of the x axis, clockwise from north. */
  heading: number;
  threshold: number;
  /** Cell (x, y) at x * ny + y: 0..250: probability * 250; 255: unknown. */
  cells: Uint8Array;
}

export function readGrid(p: DataView): Grid | null {
  if (p.byteLength < 32) return null;
  const nx = p.getUint16(0, true);
  const ny = p.getUint16(2, true);
  // PackBits makes at most 128 bytes of 2. A head that claims more is false, and no memory is reserved for it.
  if (nx * ny > (p.byteLength - 32) * 64) return null;
  const cells = new Uint8Array(nx * ny);
  if (!unpackBits(new Uint8Array(p.buffer, p.byteOffset + 32, p.byteLength - 32), cells)) return null;
  const grid = {
    nx,
    ny,
    cell: p.getFloat32(4, true),
    north: p.getFloat64(8, true),
    east: p.getFloat64(16, true),
    heading: p.getFloat32(24, true),
    threshold: p.getFloat32(28, true),
    cells,
  };
  return grid.cell > 0 && [grid.north, grid.east, grid.heading].every(Number.isFinite) ? grid : null;
}

export interface DepthTile {
  row: number;
  column: number;
  side: number;
  pixel: number;
  /** The south-west corner. */
  north: number;
  east: number;
  /** m; NaN: unknown. Row after row from the south, each from the west. */
  depth: Float32Array;
  /** 0..20 */
  confidence: Uint8Array;
  /** Bits of DepthFlag. */
  flags: Uint8Array;
}
export const DepthFlag = { charted: 1, measured: 2, obstacle: 4 } as const;

export function readDepth(p: DataView, row: number, column: number): DepthTile | null {
  if (p.byteLength < 32) return null;
  const side = p.getUint16(0, true);
  const pixels = side * side;
  // As in readGrid: a head that claims more than the bytes can hold is false.
  if (side === 0 || 4 * pixels > (p.byteLength - 32) * 64) return null;
  const planes = new Uint8Array(4 * pixels);
  if (!unpackBits(new Uint8Array(p.buffer, p.byteOffset + 32, p.byteLength - 32), planes)) return null;
  const unit = p.getFloat32(24, true);
  const tile = {
    row,
    column,
    side,
    pixel: p.getFloat32(4, true),
    north: p.getFloat64(8, true),
    east: p.getFloat64(16, true),
    depth: new Float32Array(pixels),
    confidence: planes.subarray(2 * pixels, 3 * pixels),
    flags: planes.subarray(3 * pixels),
  };
  if (!(tile.pixel > 0) || !Number.isFinite(tile.north) || !Number.isFinite(tile.east) || !(unit > 0)) return null;
  for (let i = 0; i < pixels; ++i) {
    const units = planes[i]! | (planes[pixels + i]! << 8);
    tile.depth[i] = units === 65535 ? NaN : units * unit;
  }
  return tile;
}

/** Voxels along an edge of a cube (Kind.cubes). */
export const kCubeSide = 4;

/** A block of 16 x 16 x 16 voxels or cubes. */
export interface VoxelBlock {
  size: number;
  /** Lowest corner in voxels: north, east, down. */
  corner: Point3;
  /** Number of voxels that are shown; for cubes: of the voxels in them. */
  count: number;
  /** Voxel (x, y, z) at x << 8 | y << 4 | z: probability * 250; 0: not shown. */
  shades: Uint8Array;
}

export function readVoxels(p: DataView): VoxelBlock | null {
  if (p.byteLength < 20) return null;
  const size = p.getFloat32(0, true);
  const shades = new Uint8Array(16 ** 3);
  if (!(size > 0) || !unpackBits(new Uint8Array(p.buffer, p.byteOffset + 20, p.byteLength - 20), shades)) return null;
  return {
    size,
    corner: [p.getInt32(4, true), p.getInt32(8, true), p.getInt32(12, true)],
    count: p.getUint32(16, true),
    shades,
  };
}

/** The occupied cells of the spherical grid, or the nearest of them. */
export interface Sphere {
  north: number;
  east: number;
  down: number;
  /** Lower edges of direction 0, rad: azimuth from east towards north, elevation upwards. */
  azimuth: number;
  elevation: number;
  /** Width of a direction, rad. */
  step: number;
  /** Outer radius of each layer, m. */
  radii: Float32Array;
  /** Rows of layer, azimuth, elevation, probability * kCertain (plus kLocked); the nearest first. */
  cells: Uint16Array;
  /** Cells that the grid has. */
  all: number;
}

/** The state of a cell that is certainly occupied. */
export const kCertain = 250;

/** The state of a cell that further echoes no longer change. */
export const kLocked = 0x8000;

export function readSphere(p: DataView): Sphere | null {
  const kFirst = 44;
  if (p.byteLength < kFirst) return null;
  const [layers, count, all] = [32, 36, 40].map((at) => p.getUint32(at, true)) as [number, number, number];
  if (p.byteLength !== kFirst + 4 * layers + 8 * count || all < count) return null;
  const cells = new Uint16Array(4 * count);
  for (let i = 0; i < cells.length; ++i) cells[i] = p.getUint16(kFirst + 4 * layers + 2 * i, true);
  for (let i = 0; i < cells.length; i += 4) if (cells[i]! >= layers) return null;
  const [azimuth, elevation, step] = floats(p, 20, 3) as unknown as [number, number, number];
  const sphere: Sphere = {
    north: p.getFloat64(0, true),
    east: p.getFloat64(8, true),
    down: p.getFloat32(16, true),
    azimuth,
    elevation,
    step,
    radii: floats(p, kFirst, layers),
    cells,
    all,
  };
  const numbers = [sphere.north, sphere.east, sphere.down, azimuth, elevation, step, ...sphere.radii];
  return numbers.every(Number.isFinite) ? sphere : null;
}

function floats(p: DataView, from: number, count: number): Float32Array {
  const out = new Float32Array(count);
  for (let i = 0; i < count; ++i) out[i] = p.getFloat32(from + 4 * i, true);
  return out;
}

/** The head of a slice of packed records: its place in them, and how long they are. */
export interface Slice {
  offset: number;
  total: number;
  bytes: Uint8Array;
}
const kMostPacked = 1 << 26;

export function readSlice(p: DataView): Slice | null {
  if (p.byteLength < 8) return null;
  const [offset, total] = [p.getUint32(0, true), p.getUint32(4, true)];
  if (total > kMostPacked || offset + p.byteLength - 8 > total) return null;
  return { offset, total, bytes: new Uint8Array(p.buffer, p.byteOffset + 8, p.byteLength - 8) };
}
