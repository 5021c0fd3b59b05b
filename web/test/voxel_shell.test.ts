import { describe, expect, it } from 'vitest';
import * as encode from '../fixtures/encode';
import { Model } from '../src/model';
import { Kind } from '../src/protocol';
import { writeRecord } from '../src/record_writer';
import { kCell, VoxelShell } from '../src/space/voxel_shell';

const block = (number: bigint, corner: [number, number, number], voxels: number[][]) =>
  writeRecord({ kind: Kind.voxels, number, time: 0n, payload: encode.voxelBytes(0.5, corner, voxels) });
const cubes = (number: bigint, corner: [number, number, number], places: number[][], count: number) =>
  writeRecord({ kind: Kind.cubes, number, time: 0n, payload: encode.voxelBytes(2, corner, places, count) });
/** A solid cube of voxels from (a, a, a) to (b, b, b), both within. */
function cube(a: number, b: number): number[][] {
  const out: number[][] = [];
  for (let x = a; x <= b; ++x) for (let y = a; y <= b; ++y) for (let z = a; z <= b; ++z) out.push([x, y, z, 200]);
  return out;
}
const count = (pieces: Float32Array[]) => pieces.reduce((sum, cells) => sum + cells.length / kCell, 0);

describe('the voxels that can be seen', () => {
  it('are those with a free side', () => {
    const model = new Model();
    model.take(block(1n, [0, 0, 0], cube(4, 6)));
    expect(count(new VoxelShell().of(model))).toBe(26);
  });

  it('are where the voxels are, with size and probability', () => {
    const model = new Model();
    model.take(block(1n, [-16, 32, 0], [[1, 2, 3, 250]]));
    expect([...new VoxelShell().of(model)[0]!]).toEqual([-7.25, 17.25, 1.75, 1, 0.5]);
  });

  it('are not those that only the side of a block lays bare', () => {
    const model = new Model();
    let number = 0n;
    for (const x of [-16, 0]) {
      for (const y of [-16, 0]) for (const z of [-16, 0]) model.take(block(++number, [x, y, z], cube(0, 15)));
    }
    expect(count(new VoxelShell().of(model))).toBe(32 ** 3 - 30 ** 3);
  });

  it('are larger cubes where they are too many, and none is left out', () => {
    const model = new Model();
    model.take(block(1n, [-16, 0, 0], [...cube(0, 3), [15, 15, 15, 250]]));
    const shell = new VoxelShell();
    expect(count(shell.of(model, 57))).toBe(57);
    const [cells] = shell.of(model, 20) as [Float32Array];
    expect(shell.side).toBe(2);
    expect(cells.length / kCell).toBe(9);
    expect([...cells.slice(0, kCell)]).toEqual([-7.5, 0.5, 0.5, expect.closeTo(0.8, 6), 1]);
    expect([...cells.slice(8 * kCell)]).toEqual([-0.5, 7.5, 7.5, 1, 1]);
  });

  it('are cubes where they have not come, and themselves from then on', () => {
    const model = new Model();
    const shell = new VoxelShell();
    // 200 voxels in two blocks of one region, and a region beside it
    model.take(cubes(1n, [-16, 0, 0], [[0, 0, 0, 240], [15, 15, 15, 130]], 28));
    model.take(cubes(2n, [0, 0, 0], [[0, 0, 0, 200]], 1));
    expect(shell.of(model).map((cells) => [...cells])).toEqual([
      [-31, 1, 1, expect.closeTo(0.96, 6), 2, -1, 31, 31, expect.closeTo(0.52, 6), 2],
      [1, 1, 1, expect.closeTo(0.8, 6), 2],
    ]);
    expect(shell.side).toBe(4);
    model.take(block(1n, [-64, 0, 0], cube(0, 1)));
    expect(count(shell.of(model)), 'most have not come').toBe(3);
    model.take(block(1n, [-64, 0, 0], cube(0, 2)));
    model.take(block(2n, [-16, 48, 48], [[15, 15, 15, 130]]));
    const pieces = shell.of(model);
    expect(count(pieces)).toBe(26 + 1 + 1);
    expect(pieces.at(-1)![4], 'the other region is still in cubes').toBe(2);
    expect(shell.side).toBe(4);
    model.take(block(3n, [0, 0, 0], [[1, 1, 1, 200]]));
    expect(count(shell.of(model))).toBe(26 + 1 + 1);
    expect(shell.side).toBe(1);
    model.dropVoxels();
    expect(count(shell.of(model))).toBe(3);
  });

  it('are cubes of cubes where even these are too many', () => {
    const model = new Model();
    model.take(cubes(1n, [0, 0, 0], cube(0, 3), 4096));
    const shell = new VoxelShell();
    expect(count(shell.of(model))).toBe(56);
    const [cells] = shell.of(model, 8) as [Float32Array];
    expect(cells.length / kCell).toBe(8);
    expect([...cells.slice(0, kCell)]).toEqual([2, 2, 2, expect.closeTo(0.8, 6), 4]);
    expect(shell.side).toBe(8);
  });

  it('change with the block beside', () => {
    const model = new Model();
    const shell = new VoxelShell();
    const whole = cube(0, 15);
    model.take(block(1n, [0, 0, 0], whole));
    expect(count(shell.of(model))).toBe(16 ** 3 - 14 ** 3);
    model.take(block(2n, [16, 0, 0], whole));
    expect(count(shell.of(model))).toBe(2 * (16 ** 3 - 14 ** 3) - 2 * 14 ** 2);
    model.take(writeRecord({ kind: Kind.voxels, number: 2n, time: 0n, payload: new Uint8Array(0), gone: true }));
    expect(count(shell.of(model))).toBe(16 ** 3 - 14 ** 3);
  });
});
