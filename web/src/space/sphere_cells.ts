/** Cells of the spherical grid: merged into wider ones, and chosen by layer and lock (Auran, Silven 1995, 4.2). */
import { kCertain, kLocked, type Sphere } from '../protocol';

export const whichCells = ['all', 'locked', 'open'] as const;
export type WhichCells = (typeof whichCells)[number];

/**
 * The same cells with directions and layers `times` as wide (ledger S4-17): P = 1 - prod(1 - P_i). A cell is locked if one
 * of its parts is.
 */
export function coarser(sphere: Sphere, times: number): Sphere {
  if (times === 1) return sphere;
  const wide = new Map<number, { clear: number; locked: number }>();
  const kSide = 0x10000;
  for (let i = 0; i < sphere.cells.length; i += 4) {
    const [layer, azimuth, elevation] = [0, 1, 2].map((k) => Math.floor(sphere.cells[i + k]! / times));
    const key = (layer! * kSide + azimuth!) * kSide + elevation!;
    let cell = wide.get(key);
    if (!cell) wide.set(key, (cell = { clear: 1, locked: 0 }));
    const state = sphere.cells[i + 3]!;
    cell.clear *= 1 - probability(state);
    cell.locked |= state & kLocked;
  }
  const cells = new Uint16Array(4 * wide.size);
  let row = 0;
  for (const [key, { clear, locked }] of wide) {
    const state = Math.round(kCertain * (1 - clear)) | locked;
    cells.set([Math.floor(key / kSide ** 2), Math.floor(key / kSide) % kSide, key % kSide, state], row);
    row += 4;
  }
  const radii = sphere.radii.filter((_, i) => i % times === times - 1 || i === sphere.radii.length - 1);
  return { ...sphere, step: sphere.step * times, radii, cells };
}

/** The cells of the layers from `first` to `last` (ledger S4-16), and of these the locked or the open ones (S4-14). */
export function chosen(cells: Uint16Array, first: number, last: number, which: WhichCells): Uint16Array {
  const out = new Uint16Array(cells.length);
  let length = 0;
  for (let i = 0; i < cells.length; i += 4) {
    const layer = cells[i]!;
    if (layer < first || layer > last || (which !== 'all' && isLocked(cells[i + 3]!) !== (which === 'locked')))
      continue;
    out.set(cells.subarray(i, i + 4), length);
    length += 4;
  }
  return out.subarray(0, length);
}

/** Outer radius of the last cell, m; 0 without any. */
export function farthest({ cells, radii }: Sphere): number {
  return cells.length > 0 ? radii[cells.at(-4)!]! : 0;
}

export const probability = (state: number): number => Math.min(1, (state & ~kLocked) / kCertain);
export const isLocked = (state: number): boolean => (state & kLocked) !== 0;
export function lockedIn(cells: Uint16Array): number {
  let count = 0;
  for (let i = 3; i < cells.length; i += 4) if (isLocked(cells[i]!)) ++count;
  return count;
}
