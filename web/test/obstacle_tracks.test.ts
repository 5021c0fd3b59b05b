import { describe, expect, it } from 'vitest';
import { readObstacles } from '../src/items';
import { distanceTo, tracked, trackedAt, words } from '../src/plan/obstacle_tracks';
import type { Point } from '../src/protocol';

const square = (n: number, e: number, half = 1): Point[] => [
  [n - half, e - half],
  [n + half, e - half],
  [n + half, e + half],
  [n - half, e + half],
];
const all = (...obstacles: object[]) => tracked(readObstacles(obstacles)!);

describe('what is known of an obstacle', () => {
  it('is what is remembered of it and every piece that the last scan has seen', () => {
    const [three, other, ...more] = all(
      { outline: square(10, 0), of: 3 },
      { outline: square(13, 0), of: 3 },
      { outline: square(50, 0), of: 8 },
      { id: 3, margin_m: 1, since_s: 1, seen_s: 9 },
    );
    expect(more).toEqual([]);
    expect(three).toMatchObject({ id: 3, outlines: [square(10, 0), square(13, 0)] });
    expect(three!.remembered?.since).toBe(1);
    expect(other!.id, 'no remembered obstacle has its number').toBeUndefined();
    expect(other!.outlines).toEqual([square(50, 0)]);
  });

  it('is nothing without an outline', () => {
    expect(all({ id: 3, margin_m: 1 }, { existence: 0.5 })).toEqual([]);
  });

  it('lies where its outline is, or within reach of it; the nearer one where two do', () => {
    const both = all({ id: 1, outline: square(0, 0) }, { id: 2, outline: square(10, 0) });
    expect(trackedAt(both, [0.5, 0.5], 0.1)?.id).toBe(1);
    expect(trackedAt(both, [1.3, 0], 0.2)).toBeNull();
    expect(trackedAt(both, [4, 0], 6)?.id).toBe(1);
    expect(trackedAt(both, [6, 0], 6)?.id).toBe(2);
  });

  it('with a number is meant where another without lies upon it', () => {
    expect(trackedAt(all({ outline: square(0, 0, 3) }, { id: 5, outline: square(0, 0) }), [0, 0], 1)?.id).toBe(5);
  });

  it('is as far away as the nearest place of its outline, between corners too, and in that direction', () => {
    const [t] = all({ id: 1, outline: square(0, 10) });
    expect(distanceTo(t!, [0.3, 0])).toEqual({ metres: 9, bearing: Math.PI / 2 });
    const corner = distanceTo(t!, [-4, 5]);
    expect(corner.metres).toBeCloseTo(5);
    expect(corner.bearing).toBeCloseTo(Math.atan2(4, 3));
    expect(distanceTo(t!, [0, 10]).metres).toBe(0);
  });

  it('is said in words with units', () => {
    const [t] = all({ id: 3, outline: square(15.2, 0), margin_m: 1.24, since_s: 100, seen_s: 110 });
    expect(words(t!, 112, [0, 0])).toBe(
      'Obstacle 3: known for 12 s, last seen 2.0 s ago, 14.2 m away, bearing 000°, margin 1.2 m',
    );
    expect(words(t!, 112, null)).toBe('Obstacle 3: known for 12 s, last seen 2.0 s ago, margin 1.2 m');
  });

  it('is said with what is missing left out', () => {
    const [told, seen] = all({ id: 4, outline: square(5, 0) }, { outline: square(0, 20), existence: 0.876 });
    expect(words(told!, 30, [0, 0])).toBe('Obstacle 4: 4.0 m away, bearing 000°, margin 0.0 m');
    expect(words(seen!, 30, [0, 0])).toBe(
      'Obstacle: seen by the last scan, not yet remembered, existence 88 %, 19.0 m away, bearing 090°',
    );
  });

  it('says where in the water it is, as far as that is known', () => {
    const [t] = all({ id: 3, outline: square(15.2, 0) }, { of: 3, outline: square(15.2, 0), label: 'standing' });
    expect(words(t!, 112, null)).toBe('Obstacle 3: stands in the water, margin 0.0 m');
    const [other] = all({ outline: square(15.2, 0), existence: 1, label: 'a hat' });
    expect(words(other!, 112, null)).toBe('Obstacle: seen by the last scan, not yet remembered, existence 100 %');
  });
});
