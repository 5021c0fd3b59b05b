/**
 * The voxels that can be seen: those with nothing but neighbours round them are left out. What was found of a block is
 * kept until it or a block beside it changes.
 */
import type { Model, Revised } from '../model';
import type { VoxelBlock } from '../protocol';

/** Numbers a voxel: north, east, down of its middle, probability, size. */
export const kCell = 5;
const kSide = 16;
const kSteps = [1, -1].flatMap((step) => [0, 1, 2].map((axis) => [0, 1, 2].map((k) => (k === axis ? step : 0))));

interface Found {
  revisions: string;
  cells: Float32Array;
  /** The same in cubes of 2, 4, ... voxels a side. */
  coarse: Map<number, Float32Array>;
}
type Block = Revised<VoxelBlock>;

export class VoxelShell {
  /** Voxels along an edge of the cubes that were told last. */
  side = 1;
  private found = new Map<string, Found>();
  private readonly filled = new WeakMap<VoxelBlock, Uint8Array>();

  /** By block; in larger cubes where there are more than `most`, so that none is left out. */
  of(model: Model, most = Infinity): Float32Array[] {
    const places = new Map<number, Block>();
    for (const block of model.voxels.values()) places.set(placeOf(block.item.corner), block);
    const found = new Map<string, Found>();
    for (const [key, block] of model.voxels) {
      const beside = kSteps.map((step) => places.get(placeOf(block.item.corner.map((v, k) => v + kSide * step[k]!))));
      const revisions = `${block.revision} ${beside.map((b) => b?.revision ?? 0).join()}`;
      const known = this.found.get(key);
      found.set(
        key,
        known?.revisions === revisions ? known : { revisions, cells: this.look(block, beside), coarse: new Map() },
      );
    }
    this.found = found;
    for (let side = 1; ; side *= 2) {
      const pieces = [...found.values()].map((block) => inCubes(block, side));
      const count = pieces.reduce((sum, cells) => sum + cells.length / kCell, 0);
      this.side = side;
      if (count <= most || side === kSide) return pieces;
    }
  }

  private look({ item }: Block, beside: readonly (Block | undefined)[]): Float32Array {
    const here = this.fill(item);
    const there = beside.map((block) => block && this.fill(block.item));
    const { voxels, corner, count, size } = item;
    const cells = new Float32Array(kCell * count);
    let n = 0;
    for (let v = 0; v < 4 * count; v += 4) {
      const [x, y, z] = [voxels[v]!, voxels[v + 1]!, voxels[v + 2]!];
      const i = indexOf(x, y, z);
      // Across a side, the place in the next block differs in one coordinate only.
      const hidden =
        (x < 15 ? here[i + 0x100] : there[0]?.[i & 0x0ff]) === 1 &&
        (y < 15 ? here[i + 0x010] : there[1]?.[i & 0xf0f]) === 1 &&
        (z < 15 ? here[i + 0x001] : there[2]?.[i & 0xff0]) === 1 &&
        (x > 0 ? here[i - 0x100] : there[3]?.[i | 0xf00]) === 1 &&
        (y > 0 ? here[i - 0x010] : there[4]?.[i | 0x0f0]) === 1 &&
        (z > 0 ? here[i - 0x001] : there[5]?.[i | 0x00f]) === 1;
      if (hidden) continue;
      const to = kCell * n++;
      cells[to] = (corner[0] + x + 0.5) * size;
      cells[to + 1] = (corner[1] + y + 0.5) * size;
      cells[to + 2] = (corner[2] + z + 0.5) * size;
      cells[to + 3] = voxels[v + 3]! / 250;
      cells[to + 4] = size;
    }
    return cells.slice(0, kCell * n);
  }

  private fill(block: VoxelBlock): Uint8Array {
    let filled = this.filled.get(block);
    if (!filled) {
      filled = new Uint8Array(kSide ** 3);
      const { voxels } = block;
      for (let v = 0; v < 4 * block.count; v += 4) filled[indexOf(voxels[v]!, voxels[v + 1]!, voxels[v + 2]!)] = 1;
      this.filled.set(block, filled);
    }
    return filled;
  }
}

function inCubes({ cells, coarse }: Found, side: number): Float32Array {
  if (side === 1) return cells;
  let out = coarse.get(side);
  if (out) return out;
  const cubes = new Map<number, number>();
  out = new Float32Array(cells.length);
  let n = 0;
  for (let at = 0; at < cells.length; at += kCell) {
    const size = cells[at + 4]! * side;
    const [x, y, z] = [0, 1, 2].map((k) => Math.floor(cells[at + k]! / size)) as [number, number, number];
    const to = cubes.get(indexOf(x, y, z)) ?? kCell * n++;
    cubes.set(indexOf(x, y, z), to);
    out.set([(x + 0.5) * size, (y + 0.5) * size, (z + 0.5) * size, Math.max(out[to + 3]!, cells[at + 3]!), size], to);
  }
  out = out.slice(0, kCell * n);
  coarse.set(side, out);
  return out;
}

const indexOf = (x: number, y: number, z: number): number => ((x & 15) << 8) | ((y & 15) << 4) | (z & 15);

/** 17 bits an axis, round nought: enough for a map of 30 km in quarters of a metre. */
const placeOf = (corner: readonly number[]): number =>
  ((corner[0]! & 0x1ffff) * 0x20000 + (corner[1]! & 0x1ffff)) * 0x20000 + (corner[2]! & 0x1ffff);
