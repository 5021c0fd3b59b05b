import { describe, expect, it } from 'vitest';
import { Demo } from '../fixtures/demo';
import * as encode from '../fixtures/encode';
import { Marks } from '../src/marks';
import { Model } from '../src/model';
import { Kind, kHead, padded, readRecords } from '../src/protocol';
import { joined, jsonBytes, writeRecord, type NewRecord } from '../src/record_writer';

const start = 1_700_000_000n * 1_000_000_000n;
const at = (seconds: number) => start + BigInt(Math.round(seconds * 1e9));
const json = (kind: number, value: unknown, more: Partial<NewRecord> = {}) =>
  writeRecord({ kind, time: at(0), payload: jsonBytes(value), ...more });
const scene = (more: object = {}) => json(Kind.scene, { title: 'a run', start_ns: String(start), ...more });
const decision = (n: number, seconds = n, more: Partial<NewRecord> = {}) =>
  json(
    Kind.decision,
    { agent: 'Captain', what: `w${n}`, reason: 'r' },
    { number: BigInt(n), time: at(seconds), ...more },
  );
const sonar = (bins = 4) =>
  json(
    Kind.sonar,
    {
      name: 'head',
      azimuth: [-0.5, 0, 0.5],
      width: [0.1, 0.1, 0.1],
      first_m: 1,
      bin_m: 0.5,
      bins,
      scale: { unit: 'dB', low: 0, high: 51 },
    },
    { number: 0n },
  );
const echoes = (first: number, decided: number[], seconds = 1, beams = 1) =>
  writeRecord({
    kind: Kind.echoes,
    number: encode.pair(0, first),
    time: at(seconds),
    payload: encode.echoesBytes({
      beams,
      bins: 4,
      place: [10, 20, 3],
      rotation: [Math.SQRT1_2, 0, 0, Math.SQRT1_2], // a quarter turn: looks east
      intensity: Uint8Array.from({ length: 4 * beams }, (_, i) => i + 1),
      decided: Uint8Array.from(decided),
    }),
  });

function told(...records: Uint8Array[]): Model {
  const model = new Model();
  model.take(joined(records));
  return model;
}

describe('items', () => {
  it('replace one another, and their revisions grow', () => {
    const model = told(scene());
    const before = model.revision[Kind.scene]!;
    model.take(scene({ title: 'the same run' }));
    expect(model.scene?.title).toBe('the same run');
    expect(model.revision[Kind.scene]).toBeGreaterThan(before);
  });

  it('that are gone are gone', () => {
    const tile = encode.voxelBytes(1, [0, 0, 0], [[0, 0, 0, 200]]);
    const model = told(writeRecord({ kind: Kind.voxels, number: 5n, time: 0n, payload: tile }));
    expect(model.voxels.size).toBe(1);
    model.take(writeRecord({ kind: Kind.voxels, number: 5n, time: 0n, gone: true }));
    expect(model.voxels.size).toBe(0);
  });

  it('of a kind are forgotten where a record says so of its kind', () => {
    const tile = encode.voxelBytes(1, [0, 0, 0], [[0, 0, 0, 200]]);
    const voxels = (number: bigint, forgetKind = false) =>
      writeRecord({ kind: Kind.voxels, number, time: 0n, payload: tile, forgetKind });
    const model = told(scene(), voxels(1n), voxels(2n));
    model.take(joined([voxels(3n, true), voxels(4n)]));
    expect([...model.voxels.keys()]).toEqual(['0,3', '0,4']);
    expect(model.scene).not.toBeNull();
  });

  it('are all forgotten where a record says so, and that record is taken', () => {
    const model = told(scene(), sonar(), echoes(0, [0, 1, 0, 0]), decision(0));
    model.take(decision(7, 7, { forget: true }));
    expect(model.scene).toBeNull();
    expect(model.sonars.size).toBe(0);
    expect(model.trail.size).toBe(0);
    expect(model.decisions.map((d) => d.number)).toEqual([7]);
  });

  it('that do not fit change nothing, are counted, and cost only themselves', () => {
    const model = told(
      scene(),
      writeRecord({ kind: Kind.vehicle, time: 0n, payload: new Uint8Array(8) }),
      writeRecord({ kind: Kind.health, time: 0n, payload: new TextEncoder().encode('{"counts":') }),
      writeRecord({ kind: Kind.obstacles, time: 0n, payload: jsonBytes({ not: 'a list' }) }),
      decision(1),
      Uint8Array.of(1, 2, 3),
    );
    expect([...model.malformed]).toEqual([
      ['vehicle', 1],
      ['health', 1],
      ['obstacles', 1],
      ['message cut short', 1],
    ]);
    expect(model.vehicle).toBeNull();
    expect(model.decisions).toHaveLength(1);
  });

  it('of JSON need none of their keys', () => {
    const model = told(
      ...[Kind.scene, Kind.way, Kind.decision, Kind.health].map((kind) => json(kind, {})),
      json(Kind.obstacles, [{}, null, 3]),
    );
    expect(model.malformed.size).toBe(0);
    expect(model.scene?.vehicle.length).toBeGreaterThan(0);
    expect(model.pieces).toHaveLength(1);
    expect(model.pieces[0]!.id).toBeUndefined();
  });

  it('tell an obstacle that is remembered from one that is seen by its number', () => {
    const outline = [[1, 2], [3, 4], [5, 6]]; // prettier-ignore
    const model = told(
      json(Kind.obstacles, [
        { outline, existence: 0.9 },
        { id: 0, outline, margin_m: 1.5 },
      ]),
    );
    expect(model.pieces.map(({ id, margin }) => [id, margin])).toEqual([
      [undefined, 0],
      [0, 1.5],
    ]);
  });

  it('tell of an obstacle since when it is known, where it was, and what the last scan has seen of it', () => {
    const outline = [[1, 2], [3, 4], [5, 6]]; // prettier-ignore
    const model = told(
      json(Kind.obstacles, [
        { outline, existence: 0.9, of: 7 },
        { id: 7, margin_m: 1, since_s: 3.5, seen_s: 12, trail: [[1, 2], [1, 'x'], [2, 2.5]] }, // prettier-ignore
      ]),
    );
    const [seen, known] = model.pieces;
    expect([seen!.of, seen!.id, seen!.trail]).toEqual([7, undefined, []]);
    expect([known!.of, known!.since, known!.seen, known!.outline]).toEqual([undefined, 3.5, 12, []]);
    expect(known!.trail).toEqual([[1, 2], [2, 2.5]]); // prettier-ignore
  });

  it('list obstacles as things beside the pieces that they are made of', () => {
    const outline = [[1, 2], [3, 4], [5, 6]]; // prettier-ignore
    const wall = { number: 3, kind: 'extended', extent_m: 12.4, existence: 0.98, in_scan: true };
    const model = told(
      json(Kind.obstacles, {
        obstacles: [wall, { kind: 'compact' }, 7],
        pieces: [
          { number: 3, outline },
          { number: 3, outline },
        ],
      }),
    );
    expect(model.obstacles, 'what has no number is none').toHaveLength(1);
    expect(model.obstacles[0]).toMatchObject({ number: 3, kind: 'extended', extent: 12.4, inScan: true });
    expect(model.pieces.map((p) => p.number)).toEqual([3, 3]);
    model.take(json(Kind.obstacles, {}, { gone: true }));
    expect([model.obstacles, model.pieces]).toEqual([[], []]);
  });

  it('of JSON believe nothing of another type', () => {
    const model = told(
      json(Kind.scene, {
        title: 4,
        fence: [[1], ['a', 2], [3, 4], [5, null]],
        mission: [{ at: 'x' }, { at: [1, 2], name: {} }],
        start_ns: 'soon',
      }),
    );
    expect(model.scene).toMatchObject({ title: '', fence: [[3, 4]], start: 0 });
    expect(model.scene?.mission).toMatchObject([{ name: '', at: [1, 2] }]);
  });
});

describe('decisions', () => {
  it('stand in the order of their numbers, once each', () => {
    const model = told(scene(), decision(2), decision(0), decision(1), decision(2));
    expect(model.decisions.map((d) => d.number)).toEqual([0, 1, 2]);
  });

  it('have the number that the program gave them, on the time line too', () => {
    const why = { obstacle: 3, obstacle_m: [4, 5], leg: 1 };
    const said = { number: 6, agent: 'navigator', what: 'replan', reason: 'r', ...why };
    const model = told(scene(), json(Kind.decision, said, { number: 6n, time: at(22) }));
    expect(model.decisions[0]).toMatchObject({ number: 6, obstacleNumber: 3, obstacle: [4, 5], leg: 1 });
    const marks = new Marks(model);
    marks.update();
    expect([...marks.all.values()].map(({ what }) => what)).toEqual(['6. navigator: replan']);
  });
});

describe('echoes', () => {
  it('lie beam by beam in the picture of their sonar', () => {
    const model = told(sonar(), echoes(1, [0, 0, 1, 0, 1, 0, 0, 0], 2, 2));
    const image = model.sonars.get(0)!;
    expect([...image.intensity]).toEqual([0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8]);
    expect([...image.decided]).toEqual([0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0]);
    expect([image.heard[0], image.heard[1]]).toEqual([NaN, 1_700_000_002]);
    expect(image.valueOf(255)).toBe(51);
  });

  it('are where they were heard, the nearest of a run of bins', () => {
    const model = told(sonar(), echoes(1, [0, 1, 1, 0]));
    expect(model.trail.size).toBe(1);
    // Beam 1 looks along the boresight, which is east; bin 1 has its middle at 1 + 1.5 * 0.5 m.
    const [north, east, down] = model.trail.places;
    expect([north, east, down].map((v) => Math.round(v! * 1000) / 1000)).toEqual([10, 21.75, 3]);
  });

  it('to starboard are clockwise of the boresight', () => {
    const model = told(sonar(), echoes(2, [1, 0, 0, 0]));
    const [north, east] = model.trail.places;
    expect(north).toBeCloseTo(10 - 1.25 * Math.sin(0.5), 5);
    expect(east).toBeCloseTo(20 + 1.25 * Math.cos(0.5), 5);
  });

  it('wait for a sonar that is told after them', () => {
    const model = told(echoes(1, [0, 1, 0, 0]), sonar());
    expect(model.trail.size).toBe(1);
    expect(model.malformed.size).toBe(0);
  });

  it('of more beams or other bins than the sonar has are refused', () => {
    const model = told(sonar(), echoes(2, [0, 0, 0, 0, 0, 0, 0, 0], 1, 2), sonar(5), echoes(0, [1, 0, 0, 0]));
    expect(model.malformed.get('echoes')).toBe(2);
  });
});

describe('time', () => {
  it('is that of the clock, and ages are by it', () => {
    const model = told(scene(), decision(0, 3), json(Kind.clock, { now_s: 5, end_s: 9, live: true, playing: true }));
    expect(model.now).toBe(5);
    expect(model.age(model.decisions[0]!.time)).toBeCloseTo(2, 6);
  });

  it('knows a now in a run alone, also while its past is shown', () => {
    const clock = { now_s: 5, start_s: 0, end_s: 9, live: false, playing: true };
    expect(told(json(Kind.clock, clock)).clock?.hasNow).toBe(false);
    expect(told(json(Kind.clock, { ...clock, live_s: 12 })).clock?.hasNow).toBe(true);
  });

  it('marks what was decided and what was raised, and keeps it over a jump back', () => {
    const model = told(
      scene(),
      decision(0, 3),
      json(Kind.health, { faults: [{ fault: 'leak', active: true, since_s: 8 }] }),
    );
    const marks = new Marks(model);
    marks.update();
    model.take(json(Kind.scene, { title: 'a run', start_ns: String(start) }, { forget: true }));
    marks.update();
    expect([...marks.all.values()]).toEqual([
      { at: 3, what: '0. Captain: w0', alarm: false },
      { at: 8, what: 'leak', alarm: true },
    ]);
    model.take(json(Kind.scene, { start_ns: '5' }, { forget: true }));
    marks.update();
    expect(marks.all.size).toBe(0);
  });
});

describe('a whole run', () => {
  const demo = new Demo(16, 40);
  const blocks = Array.from({ length: 400 }, () => demo.next());

  it('is understood to the last record', () => {
    const model = new Model();
    for (const block of blocks) model.take(block);
    expect([...model.malformed]).toEqual([]);
    expect(model.sonars.size).toBe(3);
    expect(model.depth.size).toBe(25);
    expect(model.decisions.length).toBeGreaterThan(2);
    expect(model.obstacles.length).toBeGreaterThan(0);
    expect(model.track.size).toBe(2);
  });

  it('that is damaged anywhere throws nowhere', () => {
    let state = 3;
    const random = (n: number) => (state = (state * 48271) % 2147483647) % n;
    const all = joined(blocks.slice(0, 30));
    for (let round = 0; round < 60; ++round) {
      const bad = all.slice();
      for (let k = 0; k < 40; ++k) bad[random(bad.length)] = random(256);
      expect(() => new Model().take(bad)).not.toThrow();
    }
  });

  it('with each payload damaged throws nowhere', () => {
    let state = 5;
    const random = (n: number) => (state = (state * 48271) % 2147483647) % n;
    const model = new Model();
    for (const block of blocks.slice(0, 120)) {
      const bad = block.slice();
      const places: [number, number][] = [];
      let from = 0;
      readRecords(block, ({ payload }) => {
        places.push([from + kHead, payload.byteLength]);
        from += kHead + padded(payload.byteLength);
      });
      for (const [begin, size] of places)
        for (let k = 0; k < 3 && size > 0; ++k) bad[begin + random(Math.min(size, 60))] = random(256);
      expect(() => model.take(bad)).not.toThrow();
    }
    expect(model.malformed.size).toBeGreaterThan(0);
  });
});
