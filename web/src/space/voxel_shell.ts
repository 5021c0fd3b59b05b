/**
 * VoxelShell: the visible voxels; voxels that are enclosed by neighbours are left out. Larger cubes represent a region
 * whose voxels have not arrived or were not requested. The result of a block is kept until the block or a neighbouring
 * block changes.
 */
import type { Model, Revised } from '../model';
import { kCubeSide, type VoxelBlock } from '../protocol';

/** Numbers per voxel: north, east, down of its centre, probability, size. */
export const kCell = 5;
const kSide = 16;
const kLevels = Math.log2(kSide);
const kCubeLevel = Math.log2(kCubeSide);
const kSteps = [1, -1].flatMap((step) => [0, 1, 2].map((axis) => [0, 1, 2].map((k) => (k === axis ? step : 0))));
/** Share of a region's voxels from which on they replace its cubes; the two counts may differ a little. */
const kNearlyAll = 0.9;

type Block = Revised<VoxelBlock>;
interface Found {
  block: Block;
  /** Revisions of this block and of its neighbours. */
  revisions: readonly number[];
  /** [k]: the cubes of 2^k voxels a side that contain a visible voxel. */
  levels: Level[];
}
interface Level {
  shades: Uint8Array;
  /** kCell numbers for each cube. */
  cells: Float32Array;
}
/** The blocks of one voxel size. */
class Layer {
  private found = new Map<number, Found>();

  look(blocks: Iterable<Block>): void {
    const places = new Map<number, Block>();
    for (const block of blocks) places.set(placeOf(block.item.corner), block);
    const found = new Map<number, Found>();
    for (const [place, block] of places) {
      const [n, e, d] = block.item.corner;
      const revisions = [block.revision];
      for (const step of kSteps) {
        const beside = places.get(placeOf([n + kSide * step[0]!, e + kSide * step[1]!, d + kSide * step[2]!]));
        revisions.push(beside?.revision ?? 0);
      }
      const known = this.found.get(place);
      const same = known && revisions.every((revision, i) => revision === known.revisions[i]);
      found.set(place, same ? known : { block, revisions, levels: [] });
    }
    this.found = found;
  }

  /** The visible cells in cubes of 2^level voxels a side. */
  *cells(level: number): Generator<Float32Array> {
    for (const { block, levels } of this.found.values()) {
      while (levels.length <= level) {
        const finer = levels.at(-1)?.shades;
        const shades = finer ? larger(finer, kSide >> levels.length) : this.seen(block.item);
        levels.push({ shades, cells: cellsOf(block.item, shades, levels.length) });
      }
      yield levels[level]!.cells;
    }
  }

  private seen({ corner, shades }: VoxelBlock): Uint8Array {
    const [north, east, below, south, west, above] = kSteps.map(
      (step) => this.found.get(placeOf(corner.map((v, k) => v + kSide * step[k]!)))?.block.item.shades,
    );
    const out = new Uint8Array(shades.length);
    for (let i = 0; i < shades.length; ++i) {
      const shade = shades[i]!;
      if (shade === 0) continue;
      const [x, y, z] = [i & 0xf00, i & 0x0f0, i & 0x00f];
      // Across a side, the place in the next block differs in one coordinate only.
      const hidden =
        (x < 0xf00 ? shades[i + 0x100] : north?.[i & 0x0ff]) &&
        (y < 0x0f0 ? shades[i + 0x010] : east?.[i & 0xf0f]) &&
        (z < 0x00f ? shades[i + 0x001] : below?.[i & 0xff0]) &&
        (x > 0 ? shades[i - 0x100] : south?.[i | 0xf00]) &&
        (y > 0 ? shades[i - 0x010] : west?.[i | 0x0f0]) &&
        (z > 0 ? shades[i - 0x001] : above?.[i | 0x00f]);
      if (!hidden) out[i] = shade;
    }
    return out;
  }
}

/** Merges eight cells into one with their highest probability; `across` merged cells a side. */
function larger(finer: Uint8Array, across: number): Uint8Array {
  const out = new Uint8Array(across ** 3);
  const [two, row] = [2 * across, 4 * across * across];
  for (let i = 0; i < finer.length; ++i) {
    const shade = finer[i]!;
    if (shade === 0) continue;
    const x = (i / row) | 0;
    const y = ((i / two) | 0) % two;
    const to = ((x >> 1) * across + (y >> 1)) * across + ((i % two) >> 1);
    if (out[to]! < shade) out[to] = shade;
  }
  return out;
}

function cellsOf({ corner, size }: VoxelBlock, shades: Uint8Array, level: number): Float32Array {
  const across = kSide >> level;
  const edge = size * 2 ** level;
  let count = 0;
  for (let i = 0; i < shades.length; ++i) if (shades[i] !== 0) ++count;
  const cells = new Float32Array(kCell * count);
  let to = 0;
  for (let i = 0; i < shades.length; ++i) {
    if (shades[i] === 0) continue;
    cells[to++] = corner[0] * size + (((i / across / across) | 0) + 0.5) * edge;
    cells[to++] = corner[1] * size + ((((i / across) | 0) % across) + 0.5) * edge;
    cells[to++] = corner[2] * size + ((i % across) + 0.5) * edge;
    cells[to++] = shades[i]! / 250;
    cells[to++] = edge;
  }
  return cells;
}

export class VoxelShell {
  /** Voxels along an edge of the largest cubes of the last result. */
  side = 1;
  private readonly voxels = new Layer();
  private readonly cubes = new Layer();

  /** The cells by block; if there are more than `most`, in larger cubes, so that none is left out. */
  of(model: Model, most = Infinity): Float32Array[] {
    const came = new Map<number, number>();
    for (const { item } of model.voxels.values()) {
      const region = regionOf(item);
      came.set(region, (came.get(region) ?? 0) + item.count);
    }
    const inCubes = new Map<number, Block>();
    for (const block of model.cubes.values()) {
      const region = placeOf(block.item.corner);
      if ((came.get(region) ?? 0) < kNearlyAll * block.item.count) inCubes.set(region, block);
    }
    this.voxels.look([...model.voxels.values()].filter(({ item }) => !inCubes.has(regionOf(item))));
    this.cubes.look(inCubes.values());
    for (let level = 0; ; ++level) {
      const ofCubes = Math.max(0, level - kCubeLevel);
      const pieces = [...this.voxels.cells(Math.min(level, kLevels)), ...this.cubes.cells(ofCubes)];
      const count = pieces.reduce((sum, cells) => sum + cells.length / kCell, 0);
      this.side = 2 ** (inCubes.size > 0 ? ofCubes + kCubeLevel : level);
      if (count <= most || ofCubes === kLevels) return pieces;
    }
  }
}

/** Key of a block: 17 bits per axis around zero, enough for a map of 30 km in quarters of a metre. */
function placeOf(corner: readonly number[]): number {
  return ((corner[0]! & 0x1ffff) * 0x20000 + (corner[1]! & 0x1ffff)) * 0x20000 + (corner[2]! & 0x1ffff);
}
/** Key of the region whose cubes contain this block of voxels. */
function regionOf({ corner }: VoxelBlock): number {
  return placeOf(corner.map((v) => Math.floor(v / (kCubeSide * kSide)) * kSide));
}
