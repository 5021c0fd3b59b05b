import { describe, expect, it } from 'vitest';
import * as encode from '../fixtures/encode';
import { unpackBits } from '../src/packbits';
import * as protocol from '../src/protocol';
import { Kind } from '../src/protocol';
import { joined, jsonBytes, writeRecord } from '../src/record_writer';

const view = (bytes: Uint8Array) => new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
/** Bytes written by hand, as docs/live-page.md has them. */
const hand = (...bytes: number[]) => Uint8Array.from(bytes);

function records(bytes: Uint8Array): [protocol.RecordView[], number] {
  const all: protocol.RecordView[] = [];
  return [all, protocol.readRecords(bytes, (record) => all.push({ ...record }))] as unknown as [
    protocol.RecordView[],
    number,
  ];
}

describe('records', () => {
  // Byte for byte: kind 9, gone and forget, payload 0, number 0x0000000200000001, time 1.5 s.
  const worked = hand(9, 3, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 0x00, 0x2f, 0x68, 0x59, 0, 0, 0, 0);

  it('are read as the page describes them', () => {
    const all: protocol.RecordView[] = [];
    expect(protocol.readRecords(worked, (record) => all.push(record))).toBe(24);
    expect(all).toHaveLength(1);
    expect(all[0]).toMatchObject({ kind: 9, gone: true, forget: true, low: 1, high: 2, time: 1.5 });
  });

  it('are written as they are read', () => {
    expect(writeRecord({ kind: 9, number: (2n << 32n) | 1n, time: 1_500_000_000n, gone: true, forget: true })).toEqual(
      worked,
    );
  });

  it('keep their times before 1970 and after 2038', () => {
    for (const time of [-1_250_000_000n, 1_777_629_604_123_456_000n, 4_102_444_800_000_000_000n]) {
      const [all] = records(writeRecord({ kind: Kind.way, time, payload: jsonBytes({}) }));
      expect(all[0]!.time).toBeCloseTo(Number(time / 1000n) / 1e6, 5);
    }
  });

  it('end where one is cut short, at every byte', () => {
    const one = writeRecord({ kind: Kind.scene, time: 0n, payload: jsonBytes({ title: 'a' }) });
    const both = joined([one, one]);
    for (let cut = 0; cut < both.length; ++cut) {
      const [all, read] = records(both.slice(0, cut));
      expect(all).toHaveLength(cut >= one.length ? 1 : 0);
      expect(read).toBe(cut >= one.length ? one.length : 0);
    }
  });

  it('end where the head cannot be right', () => {
    const good = writeRecord({ kind: Kind.scene, time: 0n, payload: jsonBytes({}) });
    for (const [at, byte] of [
      [0, 0],
      [0, 99],
      [2, 1],
      [7, 255],
    ] as const) {
      const bad = good.slice();
      bad[at] = byte;
      const [all, read] = records(joined([good, bad, good]));
      expect(all).toHaveLength(1);
      expect(read).toBe(good.length);
    }
  });
});

describe('PackBits', () => {
  it('takes the example of the TIFF specification', () => {
    const packed = hand(0xfe, 0xaa, 0x02, 0x80, 0x00, 0x2a, 0xfd, 0xaa, 0x03, 0x80, 0x00, 0x2a, 0x22, 0xf7, 0xaa);
    const out = new Uint8Array(24);
    expect(unpackBits(packed, out)).toBe(true);
    expect([...out]).toEqual([
      0xaa,
      0xaa,
      0xaa,
      0x80,
      0x00,
      0x2a,
      0xaa,
      0xaa,
      0xaa,
      0xaa,
      0x80,
      0x00,
      0x2a,
      0x22,
      ...new Array<number>(10).fill(0xaa),
    ]);
  });

  it('gives back what was packed', () => {
    let state = 1;
    const random = () => (state = (state * 48271) % 2147483647) / 2147483647;
    for (let round = 0; round < 200; ++round) {
      const bytes: number[] = [];
      while (bytes.length < 1 + 400 * random()) {
        bytes.push(...new Array<number>(1 + Math.floor(random() ** 3 * 300)).fill(Math.floor(256 * random())));
      }
      const out = new Uint8Array(bytes.length);
      expect(unpackBits(encode.packBits(Uint8Array.from(bytes)), out)).toBe(true);
      expect([...out]).toEqual(bytes);
    }
  });

  it('skips 128, and refuses too much, too little and a run without its byte', () => {
    expect(unpackBits(hand(128, 0, 7, 128), new Uint8Array(1))).toBe(true);
    expect(unpackBits(hand(1, 7, 7), new Uint8Array(1))).toBe(false);
    expect(unpackBits(hand(0, 7), new Uint8Array(2))).toBe(false);
    expect(unpackBits(hand(255), new Uint8Array(2))).toBe(false);
    expect(unpackBits(hand(5, 1, 2), new Uint8Array(6))).toBe(false);
    expect(unpackBits(hand(129, 1), new Uint8Array(127))).toBe(false);
  });
});

describe('payloads', () => {
  it('vehicle', () => {
    const bytes = encode.vehicleBytes({
      place: [1234567.125, -2.5, 3],
      attitude: [0.25, -0.5, 3],
      velocity: [1, 2, 3],
      sigma: 0.5,
      altitude: NaN,
      wanted: [1, 2, NaN],
    });
    expect(protocol.readVehicle(view(bytes))).toEqual({
      north: 1234567.125,
      east: -2.5,
      down: 3,
      roll: 0.25,
      pitch: -0.5,
      heading: 3,
      surge: 1,
      sway: 2,
      heave: 3,
      sigma: 0.5,
      altitude: NaN,
      wantedHeading: 1,
      wantedDepth: 2,
      wantedSpeed: NaN,
    });
    expect(protocol.readVehicle(view(bytes.slice(0, 71)))).toBeNull();
    bytes.fill(255, 0, 8);
    expect(protocol.readVehicle(view(bytes))).toBeNull();
  });

  it('echoes of a slow link, where a sample stands for several beams and bins', () => {
    const bytes = encode.echoesBytes({
      beams: 2,
      bins: 2,
      place: [1, 2, 3],
      rotation: [1, 0, 0, 0],
      intensity: Uint8Array.from([10, 20, 30, 40]),
      decided: Uint8Array.from([0, 1, 0, 0]),
    });
    new DataView(bytes.buffer).setUint16(0, 3, true);
    new DataView(bytes.buffer).setUint16(2, 5, true);
    bytes.set([2, 3], 4);
    const echoes = protocol.readEchoes(view(bytes), 0)!;
    expect(echoes).toMatchObject({ beams: 3, bins: 5 });
    expect([...echoes.intensity]).toEqual([10, 10, 10, 20, 20, 10, 10, 10, 20, 20, 30, 30, 30, 40, 40]);
    expect([...echoes.decided]).toEqual([0b00011000, 0b00000011]);
  });

  it('echoes, with the bits of what was decided after the next multiple of 8', () => {
    const intensity = Uint8Array.from({ length: 15 }, (_, i) => 10 + i);
    const decided = Uint8Array.from({ length: 15 }, (_, i) => (i === 0 || i === 9 || i === 14 ? 1 : 0));
    const bytes = encode.echoesBytes({
      beams: 3,
      bins: 5,
      place: [1, 2, 3],
      rotation: [1, 0, 0, 0],
      intensity,
      decided,
    });
    expect(bytes).toHaveLength(48 + 16 + 2);
    expect([...bytes.slice(64)]).toEqual([1, 0b01000010]);
    const echoes = protocol.readEchoes(view(bytes), 7)!;
    expect(echoes).toMatchObject({ first: 7, beams: 3, bins: 5, place: [1, 2, 3], rotation: [1, 0, 0, 0] });
    expect([...echoes.intensity]).toEqual([...intensity]);
    for (let cut = 0; cut < bytes.length; ++cut) expect(protocol.readEchoes(view(bytes.slice(0, cut)), 0)).toBeNull();
  });

  it('grid', () => {
    const cells = Uint8Array.from({ length: 12 }, (_, i) => (i < 6 ? 255 : 40 * (i - 6)));
    const bytes = encode.gridBytes({ nx: 3, ny: 4, cell: 0.5, corner: [-3, 8], heading: 0.25, threshold: 0.5, cells });
    const grid = protocol.readGrid(view(bytes))!;
    expect(grid).toMatchObject({ nx: 3, ny: 4, cell: 0.5, north: -3, east: 8, heading: 0.25, threshold: 0.5 });
    expect([...grid.cells]).toEqual([...cells]);
    for (let cut = 0; cut < bytes.length; ++cut) expect(protocol.readGrid(view(bytes.slice(0, cut)))).toBeNull();
  });

  it('a grid that promises more than its bytes can hold reserves nothing', () => {
    const bytes = encode.gridBytes({
      nx: 2,
      ny: 2,
      cell: 1,
      corner: [0, 0],
      heading: 0,
      threshold: 0.5,
      cells: new Uint8Array(4),
    });
    bytes.fill(255, 0, 4);
    expect(protocol.readGrid(view(bytes))).toBeNull();
  });

  it('a depth tile', () => {
    const depth = Float32Array.from([1.25, NaN, 0, 655.34]);
    const bytes = encode.depthBytes({
      side: 2,
      pixel: 0.5,
      corner: [-16, 32],
      unit: 0.01,
      depth,
      confidence: Uint8Array.from([1, 0, 20, 5]),
      flags: Uint8Array.from([1, 0, 2, 7]),
    });
    const tile = protocol.readDepth(view(bytes), -1, 2)!;
    expect(tile).toMatchObject({ row: -1, column: 2, side: 2, pixel: 0.5, north: -16, east: 32 });
    expect(tile.depth[0]).toBeCloseTo(1.25, 5);
    expect(tile.depth[1]).toBeNaN();
    expect(tile.depth[3]).toBeCloseTo(655.34, 3);
    expect([[...tile.confidence], [...tile.flags]]).toEqual([
      [1, 0, 20, 5],
      [1, 0, 2, 7],
    ]);
    for (let cut = 0; cut < bytes.length; ++cut) expect(protocol.readDepth(view(bytes.slice(0, cut)), 0, 0)).toBeNull();
  });

  it('voxels', () => {
    const bytes = encode.voxelBytes(
      0.25,
      [-16, 32, 0],
      [
        [1, 2, 3, 250],
        [15, 15, 15, 125],
      ],
    );
    const block = protocol.readVoxels(view(bytes))!;
    expect(block).toMatchObject({ size: 0.25, corner: [-16, 32, 0], count: 2 });
    expect([block.shades[0x123], block.shades[0xfff]]).toEqual([250, 125]);
    expect(block.shades.filter((shade) => shade > 0)).toHaveLength(2);
    for (let cut = 0; cut < bytes.length; ++cut) expect(protocol.readVoxels(view(bytes.slice(0, cut)))).toBeNull();
  });

  it('a track of whole places', () => {
    const bytes = encode.trackBytes([
      [0, 1, 2, 3],
      [0.5, 4, 5, 6],
    ]);
    expect([...protocol.readTrack(view(bytes))!]).toEqual([0, 1, 2, 3, 0.5, 4, 5, 6]);
    expect(protocol.readTrack(view(bytes.slice(0, 20)))).toBeNull();
  });
});

describe('the spherical grid', () => {
  /** Two layers of 1 and 2 m, and one cell of three. */
  function sphere(layer = 1, cut = 0, all = 3): DataView {
    const bytes = new DataView(new ArrayBuffer(44 + 8 + 8 - cut));
    bytes.setFloat64(0, 30, true);
    bytes.setFloat64(8, -20, true);
    [5, -1, -1.5, 0.25].forEach((v, k) => bytes.setFloat32(16 + 4 * k, v, true));
    bytes.setUint32(32, 2, true);
    bytes.setUint32(36, 1, true);
    bytes.setUint32(40, all, true);
    [1, 2].forEach((v, k) => bytes.setFloat32(44 + 4 * k, v, true));
    if (cut === 0) [layer, 7, 6, 250].forEach((v, k) => bytes.setUint16(52 + 2 * k, v, true));
    return bytes;
  }

  it('is read as the page describes it', () => {
    expect(protocol.readSphere(sphere())).toEqual({
      north: 30,
      east: -20,
      down: 5,
      azimuth: -1,
      elevation: -1.5,
      step: 0.25,
      radii: new Float32Array([1, 2]),
      cells: new Uint16Array([1, 7, 6, 250]),
      all: 3,
    });
  });

  it('is refused where it is cut short, or names a layer that it does not have', () => {
    expect(protocol.readSphere(sphere(1, 8))).toBeNull();
    expect(protocol.readSphere(sphere(2))).toBeNull();
    expect(protocol.readSphere(sphere(1, 0, 0))).toBeNull();
    expect(protocol.readSphere(new DataView(new ArrayBuffer(43)))).toBeNull();
  });
});
