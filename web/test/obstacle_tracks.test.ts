import { describe, expect, it } from 'vitest';
import { readObstacles } from '../src/items';
import { Model } from '../src/model';
import { countOf, obstacleRows } from '../src/obstacle_list';
import { labelOf } from '../src/plan/obstacle_layer';
import { distanceTo, tracked, trackedAt, words } from '../src/plan/obstacle_tracks';
import type { Point } from '../src/protocol';

const square = (n: number, e: number, half = 1): Point[] => [
  [n - half, e - half],
  [n + half, e - half],
  [n + half, e + half],
  [n - half, e + half],
];
const all = (...pieces: object[]) => tracked(readObstacles({ pieces })!);
/** Obstacles as things, and their pieces. */
const things = (obstacles: object[], pieces: object[]) => tracked(readObstacles({ obstacles, pieces })!);

describe('what is known of an obstacle', () => {
  it('is what is said of it as a whole, every piece that the last scan has seen, and what is remembered', () => {
    const [three, other, ...more] = things(
      [
        { number: 3, kind: 'extended', extent_m: 5, in_scan: true },
        { number: 8, kind: 'compact', extent_m: 2, in_scan: true },
      ],
      [
        { number: 3, outline: square(10, 0), of: 21 },
        { number: 3, outline: square(13, 0), of: 22 },
        { number: 8, outline: square(50, 0) },
        { number: 3, id: 21, margin_m: 1, since_s: 1, seen_s: 9 },
        { number: 3, id: 22, outline: square(16, 0), margin_m: 2, since_s: 4, seen_s: 8 },
      ],
    );
    expect(more).toEqual([]);
    expect(three).toMatchObject({ number: 3, outlines: [square(10, 0), square(13, 0), square(16, 0)] });
    expect(three!.whole?.kind).toBe('extended');
    expect(three!.remembered.map(({ id }) => id)).toEqual([21, 22]);
    expect(other).toMatchObject({ number: 8, remembered: [], outlines: [square(50, 0)] });
  });

  it('in a recording of an older program goes by the numbers of what is remembered', () => {
    const [three, other] = tracked(
      readObstacles([
        { outline: square(10, 0), of: 3 },
        { outline: square(50, 0) },
        { id: 3, margin_m: 1, since_s: 1, seen_s: 9 },
      ])!,
    );
    expect(three).toMatchObject({ number: 3, outlines: [square(10, 0)], whole: undefined });
    expect(other!.number).toBeUndefined();
  });

  it('is nothing without an outline', () => {
    expect(all({ number: 3, id: 3, margin_m: 1 }, { existence: 0.5 })).toEqual([]);
    expect(things([{ number: 4, kind: 'compact' }], [])).toEqual([]);
  });

  it('lies where its outline is, or within reach of it; the nearer one where two do', () => {
    const both = all({ number: 1, outline: square(0, 0) }, { number: 2, outline: square(10, 0) });
    expect(trackedAt(both, [0.5, 0.5], 0.1)?.number).toBe(1);
    expect(trackedAt(both, [1.3, 0], 0.2)).toBeNull();
    expect(trackedAt(both, [4, 0], 6)?.number).toBe(1);
    expect(trackedAt(both, [6, 0], 6)?.number).toBe(2);
  });

  it('with a number is meant where another without lies upon it', () => {
    const two = all({ outline: square(0, 0, 3) }, { number: 5, outline: square(0, 0) });
    expect(trackedAt(two, [0, 0], 1)?.number).toBe(5);
  });

  it('is as far away as the nearest place of its outline, between corners too, and in that direction', () => {
    const [t] = all({ number: 1, outline: square(0, 10) });
    expect(distanceTo(t!, [0.3, 0])).toEqual({ metres: 9, bearing: Math.PI / 2 });
    const corner = distanceTo(t!, [-4, 5]);
    expect(corner.metres).toBeCloseTo(5);
    expect(corner.bearing).toBeCloseTo(Math.atan2(4, 3));
    expect(distanceTo(t!, [0, 10]).metres).toBe(0);
  });

  it('is said in words with units', () => {
    const [t] = things(
      [{ number: 3, kind: 'compact', extent_m: 2.83, in_scan: false, since_s: 100, seen_s: 110 }],
      [{ number: 3, id: 7, outline: square(15.2, 0), margin_m: 1.24, since_s: 100, seen_s: 110 }],
    );
    expect(words(t!, 112, [0, 0])).toBe(
      'Obstacle 3: compact, 2.8 m across, known for 12 s, last seen 2.0 s ago, 14.2 m away, bearing 000°, margin 1.2 m',
    );
    expect(words(t!, 112, null)).toBe(
      'Obstacle 3: compact, 2.8 m across, known for 12 s, last seen 2.0 s ago, margin 1.2 m',
    );
  });

  it('is said with what is missing left out', () => {
    const [told, seen] = all(
      { number: 4, id: 4, outline: square(5, 0) },
      { number: 5, outline: square(0, 20), existence: 0.876 },
    );
    expect(words(told!, 30, [0, 0])).toBe('Obstacle 4: 4.0 m away, bearing 000°, margin 0.0 m');
    expect(words(seen!, 30, [0, 0])).toBe(
      'Obstacle 5: seen by the last scan, not yet remembered, existence 88 %, 19.0 m away, bearing 090°',
    );
  });

  it('says where in the water it is, and whether another hides it, as far as that is known', () => {
    const [t] = things(
      [{ number: 3, kind: 'compact', behind: true }],
      [{ number: 3, outline: square(15.2, 0), label: 'standing' }],
    );
    expect(words(t!, 112, null)).toBe(
      'Obstacle 3: compact, seen by the last scan, not yet remembered, stands in the water, behind a nearer one',
    );
    const [other] = all({ outline: square(15.2, 0), existence: 1, label: 'a hat' });
    expect(words(other!, 112, null)).toBe('Obstacle: seen by the last scan, not yet remembered, existence 100 %');
  });
});

describe('the list of obstacles', () => {
  const sea = things(
    [
      { number: 7, kind: 'extended', extent_m: 21, in_scan: true },
      { number: 2, kind: 'compact', extent_m: 1, in_scan: true },
      { number: 4, kind: 'compact', extent_m: 1, in_scan: false },
    ],
    [
      { number: 7, outline: square(40, 0, 10) },
      { number: 7, outline: square(60, 0, 10) },
      { number: 2, outline: square(0, 12) },
      { number: 4, id: 9, outline: square(-60, 0) },
    ],
  );

  it('has one row for each, nearest to the vehicle first', () => {
    const rows = obstacleRows(sea, [0, 0]);
    expect(rows.map(({ tracked: t }) => t.number)).toEqual([2, 7, 4]);
    expect(rows.map(({ away }) => away)).toEqual([11, 30, 59]);
    expect(rows[0]!.bearing).toBeCloseTo(Math.PI / 2);
  });

  it('keeps the order of the scan where the vehicle has no position', () => {
    expect(obstacleRows(sea, null).map(({ tracked: t }) => t.number)).toEqual([7, 2, 4]);
  });

  it('counts things, not pieces', () => {
    expect(countOf(sea)).toBe('2 obstacles in the last scan, 1 more remembered');
    expect(countOf(sea.slice(0, 1))).toBe('1 obstacle in the last scan');
  });
});

describe('the label of an obstacle on the chart', () => {
  const [wall, gone] = things(
    [
      { number: 3, kind: 'extended', extent_m: 21.04 },
      { number: 4, kind: 'compact', extent_m: 1, since_s: 10, seen_s: 20 },
    ],
    [
      { number: 3, outline: square(40, 0, 10) },
      { number: 4, id: 9, outline: square(-60, 0), margin_m: 1.5 },
    ],
  );
  const at = (north: number): Model =>
    Object.assign(new Model(), { vehicle: { north, east: 0 }, clock: { now: 32 } }) as Model;

  it('is its number, and near by its kind, extent and distance', () => {
    expect(labelOf(wall!, at(0), false)).toBe('#3');
    expect(labelOf(wall!, at(0), true)).toBe('#3 extended 21.0 m, 30.0 m away');
    expect(labelOf(wall!, new Model(), true)).toBe('#3 extended 21.0 m');
  });

  it('of one that is only remembered says how sure its place is and when it was seen', () => {
    expect(labelOf(gone!, at(0), true)).toBe('#4 compact 1.0 m, ± 1.5 m, 12 s ago');
  });
});
