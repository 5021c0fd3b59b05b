import { describe, expect, it } from 'vitest';
import { alongLine } from '../src/plan/along_line';
import type { Tracked } from '../src/plan/obstacle_tracks';
import type { Point } from '../src/protocol';

const box = (number: number | undefined, north: number, east: number): Tracked => ({
  number,
  whole: undefined,
  outlines: [
    [
      [north - 1, east - 1],
      [north - 1, east + 1],
      [north + 1, east + 1],
      [north + 1, east - 1],
    ],
  ],
  remembered: [],
  seen: [],
});

describe('what the maps know along a line', () => {
  const shoal = ([north]: Point) => (north > 40 ? null : 10 - north / 10);

  it('is the least depth, and where it is unknown', () => {
    const told = alongLine([0, 0], [80, 0], shoal, [], 20);
    expect(told[0]).toMatch(/^least depth 6\.0.m, 40.* along$/);
    expect(told[1]).toMatch(/^depth unknown for (39|40)/);
    expect(alongLine([50, 0], [80, 0], shoal, [], 20)).toEqual(['depth unknown']);
    expect(alongLine([0, 0], [20, 0], null, [], 20), 'without a depth map').toEqual([]);
  });

  it('is the nearest obstacle', () => {
    expect(alongLine([0, 0], [80, 0], null, [box(3, 30, 5), box(4, 60, 9)], 20)[0]).toMatch(
      /^obstacle 3 4.0.m beside it, (29|30)/,
    );
    expect(alongLine([0, 0], [80, 0], null, [box(4, 60, 0)], 20)[0]).toMatch(/^meets obstacle 4 at (59|60)/);
    expect(alongLine([0, 0], [80, 0], null, [box(undefined, 60, 0)], 20)[0]).toMatch(/^meets an obstacle/);
    expect(alongLine([0, 0], [80, 0], null, [box(4, 60, 30)], 20)).toEqual([]);
  });

  it('is nothing for a line without length', () => {
    expect(alongLine([0, 0], [0, 0], shoal, [box(4, 0, 0)], 20)).toEqual([]);
  });
});
