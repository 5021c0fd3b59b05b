import { describe, expect, it } from 'vitest';
import { kLocked, type Sphere } from '../src/protocol';
import { chosen, coarser, lockedIn } from '../src/space/sphere_cells';

const sphere = (radii: number[], ...rows: number[][]): Sphere => ({
  north: 0,
  east: 0,
  down: 5,
  azimuth: -1,
  elevation: -1.5,
  step: 0.05,
  radii: new Float32Array(radii),
  cells: new Uint16Array(rows.flat()),
  all: rows.length,
});
const rows = (cells: Uint16Array): number[][] =>
  Array.from({ length: cells.length / 4 }, (_, i) => [...cells.subarray(4 * i, 4 * i + 4)]);

describe('wider cells', () => {
  // ledger: S4-17
  it('have the probability that one of their parts is occupied', () => {
    const wide = coarser(sphere([1, 2, 3], [0, 6, 9, 125], [1, 7, 8, 125], [1, 7, 9, 50], [2, 6, 8, 200]), 2);
    expect(rows(wide.cells)).toEqual([
      [0, 3, 4, Math.round(250 * (1 - 0.5 * 0.5 * 0.8))],
      [1, 3, 4, 200],
    ]);
    expect([...wide.radii]).toEqual([2, 3]); // the last layer has one part only
    expect(wide).toMatchObject({ azimuth: -1, elevation: -1.5, step: 0.1, down: 5, all: 4 });
  });

  it('are locked where a part is, and certain where a part is', () => {
    const wide = coarser(sphere([1, 2, 3, 4], [0, 1, 1, 140], [3, 2, 3, 250 | kLocked], [3, 4, 0, 130]), 4);
    expect(rows(wide.cells)).toEqual([
      [0, 0, 0, 250 | kLocked],
      [0, 1, 0, 130],
    ]);
    expect([...wide.radii]).toEqual([4]);
  });

  it('are the cells themselves at once their width', () => {
    const same = sphere([1], [0, 1, 2, 200]);
    expect(coarser(same, 1)).toBe(same);
  });
});

describe('the cells to draw', () => {
  const { cells } = sphere(
    [1, 2, 3],
    [0, 1, 1, 140],
    [1, 1, 1, 240 | kLocked],
    [1, 2, 1, 150],
    [2, 1, 1, 230 | kLocked],
  );

  // ledger: S4-16
  it('of some layers are those of a filter over all cells', () => {
    for (let first = 0; first < 3; ++first) {
      for (let last = first; last < 3; ++last) {
        const filtered = rows(cells).filter(([layer]) => layer! >= first && layer! <= last);
        expect(rows(chosen(cells, first, last, 'all'))).toEqual(filtered);
      }
    }
  });

  // ledger: S4-14
  it('are the locked ones, or the others', () => {
    expect(rows(chosen(cells, 0, 2, 'locked'))).toEqual([rows(cells)[1], rows(cells)[3]]);
    expect(rows(chosen(cells, 0, 1, 'open'))).toEqual([rows(cells)[0], rows(cells)[2]]);
    expect(lockedIn(cells)).toBe(2);
  });
});
