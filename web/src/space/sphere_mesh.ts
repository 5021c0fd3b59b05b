/**
 * SphereMesh: cells of the spherical grid, each as its outer face and its section at half its height, which is what one
 * sees from above. By day a cell is the darker, the more probable it is, and brown if it is locked; by night it is the
 * lighter, and amber. The cells lie around the place of the vehicle at the last scan.
 */
import { BufferAttribute, BufferGeometry, DoubleSide, Mesh, MeshBasicMaterial } from 'three';
import type { Sphere } from '../protocol';
import { put } from './frame';
import { isLocked, probability } from './sphere_cells';

/** Corners of the two faces: shares of the azimuth, the elevation and the depth of the cell. */
const kFaces = [
  [0, 0, 1],
  [1, 0, 1],
  [1, 1, 1],
  [0, 1, 1],
  [0, 0.5, 0],
  [1, 0.5, 0],
  [1, 0.5, 1],
  [0, 0.5, 1],
] as const;
const kCorners = kFaces.length;

export class SphereMesh {
  readonly mesh = new Mesh(
    new BufferGeometry(),
    new MeshBasicMaterial({ vertexColors: true, side: DoubleSide, transparent: true, opacity: 0.9 }),
  );
  private drawn: Sphere | null = null;
  private night = false;

  build(sphere: Sphere | null, night: boolean): void {
    if (sphere === this.drawn && night === this.night) return;
    this.drawn = sphere;
    this.night = night;
    const cells = sphere?.cells ?? new Uint16Array();
    const count = cells.length / 4;
    const places = new Float32Array(3 * kCorners * count);
    const colours = new Float32Array(3 * kCorners * count);
    const faces = new Uint32Array(12 * count);
    for (let k = 0; k < count; ++k) {
      const [layer, azimuth, elevation, state] = cells.subarray(4 * k, 4 * k + 4);
      const { north, east, down, step, radii } = sphere!;
      const [inner, outer] = [radii[layer! - 1] ?? 0, radii[layer!]!];
      kFaces.forEach(([right, up, out], corner) => {
        const a = sphere!.azimuth + (azimuth! + right) * step;
        const e = sphere!.elevation + (elevation! + up) * step;
        const radius = inner + out * (outer - inner);
        const level = radius * Math.cos(e);
        const [n, m] = [north + level * Math.sin(a), east + level * Math.cos(a)];
        put(places, kCorners * k + corner, n, m, down - radius * Math.sin(e));
      });
      const locked = isLocked(state!);
      const colour = (night ? nightColour : dayColour)(probability(state!), locked);
      for (let corner = 0; corner < kCorners; ++corner) colours.set(colour, 3 * (kCorners * k + corner));
      for (const [half, first] of [kCorners * k, kCorners * k + 4].entries()) {
        faces.set([first, first + 1, first + 2, first, first + 2, first + 3], 12 * k + 6 * half);
      }
    }
    const { geometry } = this.mesh;
    geometry.dispose();
    geometry.setAttribute('position', new BufferAttribute(places, 3));
    geometry.setAttribute('color', new BufferAttribute(colours, 3));
    geometry.setIndex(new BufferAttribute(faces, 1));
    geometry.computeBoundingSphere();
  }
}

function dayColour(probability: number, locked: boolean): [number, number, number] {
  const tone = 0.75 * (1 - probability);
  return locked ? [tone + 0.35, tone + 0.12, tone] : [tone, tone, tone];
}
function nightColour(probability: number, locked: boolean): [number, number, number] {
  const tone = 0.15 + 0.3 * probability;
  return locked ? [tone + 0.3, 0.6 * tone + 0.18, 0.15 * tone] : [tone, 0.42 * tone, 0.25 * tone];
}
