/**
 * SphereMesh: the occupied cells of the spherical grid, each as its outer face, the darker the more probable. The cells
 * lie around the place of the vehicle at the last scan.
 */
import { BufferAttribute, BufferGeometry, DoubleSide, Mesh, MeshBasicMaterial } from 'three';
import type { Sphere } from '../protocol';
import { put } from './frame';

export class SphereMesh {
  readonly mesh = new Mesh(
    new BufferGeometry(),
    new MeshBasicMaterial({ vertexColors: true, side: DoubleSide, transparent: true, opacity: 0.9 }),
  );
  /** Cells that are drawn. */
  shown = 0;
  private drawn: Sphere | null = null;
  private night = false;

  build(sphere: Sphere | null, night: boolean): void {
    if (sphere === this.drawn && night === this.night) return;
    this.drawn = sphere;
    this.night = night;
    const cells = sphere?.cells ?? new Uint16Array();
    this.shown = cells.length / 4;
    const places = new Float32Array(12 * this.shown);
    const colours = new Float32Array(12 * this.shown);
    const faces = new Uint32Array(6 * this.shown);
    for (let k = 0; k < this.shown; ++k) {
      const [layer, azimuth, elevation, shade] = cells.subarray(4 * k, 4 * k + 4) as unknown as number[];
      const { north, east, down, step, radii } = sphere!;
      const radius = radii[layer!]!;
      for (let corner = 0; corner < 4; ++corner) {
        const a = sphere!.azimuth + (azimuth! + (corner === 1 || corner === 2 ? 1 : 0)) * step;
        const e = sphere!.elevation + (elevation! + (corner >= 2 ? 1 : 0)) * step;
        const level = radius * Math.cos(e);
        put(places, 4 * k + corner, north + level * Math.sin(a), east + level * Math.cos(a), down - radius * Math.sin(e));
      }
      const grey = 0.75 * (1 - Math.min(1, shade! / 250));
      colours.fill(night ? 0.45 - 0.4 * grey : grey, 12 * k, 12 * k + 12);
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
