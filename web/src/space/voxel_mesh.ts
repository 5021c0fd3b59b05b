/** The voxels as cubes of one mesh: those with nothing but neighbours round them cannot be seen and are left out. */
import { BoxGeometry, Color, InstancedBufferAttribute, InstancedMesh, Matrix4, MeshLambertMaterial } from 'three';
import { rgbOf, tables } from '../colours';
import type { Model } from '../model';
import type { Theme } from '../theme';

export type VoxelColour = 'depth' | 'probability';
/** More than that is more than a screen shows, and a laptop draws. */
const kMost = 300_000;

export class VoxelMesh {
  mesh: InstancedMesh;
  colour: VoxelColour = 'depth';
  shown = 0;
  /** Depths of the scale of colours, m. */
  range: [number, number] = [0, 1];
  private readonly material = new MeshLambertMaterial();
  private readonly box = new BoxGeometry(1, 1, 1);

  constructor() {
    this.mesh = this.room(1024);
  }

  /** Returns the mesh to be shown, which is another one when it had to grow. */
  build(model: Model, theme: Theme): InstancedMesh {
    const cells = visible(model);
    const count = Math.min(kMost, cells.length / 5);
    if (count > this.mesh.instanceMatrix.count) {
      this.mesh.dispose();
      this.mesh = this.room(Math.ceil(count * 1.5));
    }
    let [low, high] = [Infinity, -Infinity];
    for (let i = 0; i < count; ++i) {
      low = Math.min(low, cells[5 * i + 2]!);
      high = Math.max(high, cells[5 * i + 2]!);
    }
    this.range = low < high ? [low, high] : [0, 1];
    const matrix = new Matrix4();
    const colour = new Color();
    const table = theme.name === 'night' ? tables.ember : tables.viridis;
    for (let i = 0; i < count; ++i) {
      const [north, east, down, p, size] = cells.subarray(5 * i, 5 * i + 5) as unknown as [
        number,
        number,
        number,
        number,
        number,
      ];
      matrix.makeScale(size * 0.96, size * 0.96, size * 0.96).setPosition(east, north, -down);
      this.mesh.setMatrixAt(i, matrix);
      // Shallow is light: it is what a keel meets first. Likely is light too.
      const share =
        this.colour === 'depth' ? 1 - (down - this.range[0]) / (this.range[1] - this.range[0]) : (p - 0.5) * 2;
      const [r, g, b] = rgbOf(table[Math.min(255, Math.max(0, Math.round(30 + 225 * share)))]!);
      this.mesh.setColorAt(i, colour.setRGB(r / 255, g / 255, b / 255, 'srgb'));
    }
    this.mesh.count = this.shown = count;
    this.mesh.instanceMatrix.needsUpdate = true;
    if (this.mesh.instanceColor) this.mesh.instanceColor.needsUpdate = true;
    this.mesh.computeBoundingSphere();
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

/** North, east, down of the middle, probability and size of each that may be seen. */
function visible(model: Model): Float32Array {
  const taken = new Set<number>();
  // 17 bits an axis, round nought: enough for a map of 30 km in quarters of a metre.
  const key = (x: number, y: number, z: number) => ((x & 0x1ffff) * 0x20000 + (y & 0x1ffff)) * 0x20000 + (z & 0x1ffff);
  let all = 0;
  for (const { item } of model.voxels.values()) {
    all += item.count;
    for (let i = 0; i < item.count; ++i) {
      const v = 4 * i;
      taken.add(
        key(
          item.corner[0] + item.voxels[v]!,
          item.corner[1] + item.voxels[v + 1]!,
          item.corner[2] + item.voxels[v + 2]!,
        ),
      );
    }
  }
  const out = new Float32Array(5 * all);
  let n = 0;
  for (const { item } of model.voxels.values()) {
    for (let i = 0; i < item.count; ++i) {
      const [x, y, z] = [0, 1, 2].map((k) => item.corner[k as 0 | 1 | 2] + item.voxels[4 * i + k]!) as [
        number,
        number,
        number,
      ];
      const hidden =
        taken.has(key(x + 1, y, z)) &&
        taken.has(key(x - 1, y, z)) &&
        taken.has(key(x, y + 1, z)) &&
        taken.has(key(x, y - 1, z)) &&
        taken.has(key(x, y, z + 1)) &&
        taken.has(key(x, y, z - 1));
      if (hidden) continue;
      const s = item.size;
      out.set([(x + 0.5) * s, (y + 0.5) * s, (z + 0.5) * s, item.voxels[4 * i + 3]! / 250, s], 5 * n++);
    }
  }
  return out.subarray(0, 5 * n);
}
