/** The voxels as cubes of one mesh. */
import { BoxGeometry, Color, InstancedBufferAttribute, InstancedMesh, MeshLambertMaterial } from 'three';
import { rgbOf, tables } from '../colours';
import type { Model } from '../model';
import type { Theme } from '../theme';
import { kCell, VoxelShell } from './voxel_shell';

export type VoxelColour = 'depth' | 'probability';

export class VoxelMesh {
  mesh: InstancedMesh;
  colour: VoxelColour = 'depth';
  /** Cubes: more than that is more than a screen shows, and a laptop draws. */
  most = 300_000;
  shown = 0;
  /** Voxels along an edge of a cube. */
  get side(): number {
    return this.shell.side;
  }
  /** Depths of the scale of colours, m. */
  range: [number, number] = [0, 1];
  private readonly shell = new VoxelShell();
  private readonly material = new MeshLambertMaterial();
  private readonly box = new BoxGeometry(1, 1, 1);

  constructor() {
    this.mesh = this.room(1024);
  }

  /** Returns the mesh to be shown, which is another one when it had to grow. */
  build(model: Model, theme: Theme): InstancedMesh {
    const pieces = this.shell.of(model, this.most);
    const count = pieces.reduce((sum, cells) => sum + cells.length / kCell, 0);
    if (count > this.mesh.instanceMatrix.count) {
      this.mesh.dispose();
      this.mesh = this.room(Math.ceil(count * 1.5));
    }
    this.range = rangeOf(pieces);
    const [low, high] = this.range;
    const matrices = this.mesh.instanceMatrix.array;
    const colours = this.mesh.instanceColor!.array;
    const table = linear(theme.name === 'night' ? tables.ember : tables.viridis);
    let i = 0;
    for (const cells of pieces) {
      for (let at = 0; at < cells.length; at += kCell, ++i) {
        const [down, size] = [cells[at + 2]!, 0.96 * cells[at + 4]!];
        const m = 16 * i; // the rest of a matrix stays nought
        matrices[m] = matrices[m + 5] = matrices[m + 10] = size;
        matrices[m + 12] = cells[at + 1]!;
        matrices[m + 13] = cells[at]!;
        matrices[m + 14] = -down;
        matrices[m + 15] = 1;
        // Shallow is light: it is what a keel meets first. Likely is light too.
        const share = this.colour === 'depth' ? 1 - (down - low) / (high - low) : (cells[at + 3]! - 0.5) * 2;
        const entry = 3 * Math.min(255, Math.max(0, Math.round(30 + 225 * share)));
        for (let k = 0; k < 3; ++k) colours[3 * i + k] = table[entry + k]!;
      }
    }
    this.mesh.count = this.shown = count;
    this.mesh.instanceMatrix.needsUpdate = true;
    this.mesh.instanceColor!.needsUpdate = true;
    return this.mesh;
  }

  private room(capacity: number): InstancedMesh {
    const mesh = new InstancedMesh(this.box, this.material, capacity);
    mesh.instanceColor = new InstancedBufferAttribute(new Float32Array(3 * capacity), 3);
    mesh.count = 0;
    mesh.frustumCulled = false;
    return mesh;
  }
}

function rangeOf(pieces: readonly Float32Array[]): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (const cells of pieces) {
    for (let at = 2; at < cells.length; at += kCell) {
      low = Math.min(low, cells[at]!);
      high = Math.max(high, cells[at]!);
    }
  }
  return low < high ? [low, high] : [0, 1];
}

/** Red, green, blue of a table as light adds them. */
function linear(table: Uint32Array): Float32Array {
  const colour = new Color();
  const out = new Float32Array(3 * 256);
  for (let i = 0; i < 256; ++i) {
    const [r, g, b] = rgbOf(table[i]!);
    colour.setRGB(r / 255, g / 255, b / 255, 'srgb').toArray(out, 3 * i);
  }
  return out;
}
