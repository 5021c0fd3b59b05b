/**
 * SphereMesh: cells of the spherical grid, each as its outer face, the darker the more probable (by night the lighter), in
 * brown if it is locked. The cells lie around the place of the vehicle at the last scan.
 */
import { BufferAttribute, BufferGeometry, DoubleSide, Mesh, MeshBasicMaterial } from 'three';
import type { Sphere } from '../protocol';
import { put } from './frame';
import { isLocked, probability } from './sphere_cells';

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
    const places = new Float32Array(12 * count);
    const colours = new Float32Array(12 * count);
    const faces = new Uint32Array(6 * count);
    for (let k = 0; k < count; ++k) {
      const [layer, azimuth, elevation, state] = cells.subarray(4 * k, 4 * k + 4) as unknown as number[];
      const { north, east, down, step, radii } = sphere!;
      const radius = radii[layer!]!;
      for (let corner = 0; corner < 4; ++corner) {
        const a = sphere!.azimuth + (azimuth! + (corner === 1 || corner === 2 ? 1 : 0)) * step;
        const e = sphere!.elevation + (elevation! + (corner >= 2 ? 1 : 0)) * step;
        const level = radius * Math.cos(e);
        put(places, 4 * k + corner, north + level * Math.sin(a), east + level * Math.cos(a), down - radius * Math.sin(e));
      }
      const locked = isLocked(state!);
      const grey = 0.75 * (1 - probability(state!));
      const tone = night ? 0.45 - 0.4 * grey : grey;
      for (let corner = 0; corner < 4; ++corner) {
        colours.set(locked ? [tone + 0.35, tone + 0.12, tone] : [tone, tone, tone], 12 * k + 3 * corner);
      }
      faces.set([4 * k, 4 * k + 1, 4 * k + 2, 4 * k, 4 * k + 2, 4 * k + 3], 6 * k);
    }
    const { geometry } = this.mesh;
    geometry.dispose();
    geometry.setAttribute('position', new BufferAttribute(places, 3));
    geometry.setAttribute('color', new BufferAttribute(colours, 3));
    geometry.setIndex(new BufferAttribute(faces, 1));
    geometry.computeBoundingSphere();
  }
}
