/** Converts W (north, east, down) to three.js (east, north, up). No other file knows the axes of three.js. */
import { BufferAttribute, BufferGeometry, Vector3 } from 'three';
import type { Model } from '../model';

export const at = (north: number, east: number, down: number): Vector3 => new Vector3(east, north, -down);
export function put(out: Float32Array, i: number, north: number, east: number, down: number): void {
  out[3 * i] = east;
  out[3 * i + 1] = north;
  out[3 * i + 2] = -down;
}

export function geometryOf(places: Float32Array): BufferGeometry {
  return new BufferGeometry().setAttribute('position', new BufferAttribute(places, 3));
}

/** The bounds of what is shown, in W. */
export class Extent {
  readonly low = [Infinity, Infinity, Infinity];
  readonly high = [-Infinity, -Infinity, -Infinity];

  add(north: number, east: number, down: number): void {
    [north, east, down].forEach((v, k) => {
      if (!Number.isFinite(v)) return;
      this.low[k] = Math.min(this.low[k]!, v);
      this.high[k] = Math.max(this.high[k]!, v);
    });
  }
  get empty(): boolean {
    return !(this.low[0]! <= this.high[0]!);
  }
}

/** The bounds of all that a run has shown: points of the mission, vehicle, voxels, depths. */
export function extentOf(model: Model): Extent {
  const extent = new Extent();
  for (const {
    at: [n, e],
    depth,
  } of model.scene?.mission ?? [])
    extent.add(n, e, depth ?? 0);
  if (model.vehicle) extent.add(model.vehicle.north, model.vehicle.east, model.vehicle.down);
  for (const { item } of [...model.voxels.values(), ...model.cubes.values()]) {
    const [n, e, d] = item.corner.map((v) => v * item.size) as [number, number, number];
    extent.add(n, e, d);
    extent.add(n + 16 * item.size, e + 16 * item.size, d);
  }
  for (const { item } of model.depth.values()) {
    let deepest = -Infinity;
    for (let i = 0; i < item.depth.length; i += 7) if (item.depth[i]! > deepest) deepest = item.depth[i]!;
    if (deepest < 0) continue;
    extent.add(item.north, item.east, deepest);
    extent.add(item.north + item.side * item.pixel, item.east + item.side * item.pixel, deepest);
  }
  return extent;
}
