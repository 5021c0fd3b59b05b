/** Converts W (north, east, down) to three.js (east, north, up). No other file knows the axes of three.js. */
import { Vector3 } from 'three';

export const at = (north: number, east: number, down: number): Vector3 => new Vector3(east, north, -down);
export function put(out: Float32Array, i: number, north: number, east: number, down: number): void {
  out[3 * i] = east;
  out[3 * i + 1] = north;
  out[3 * i + 2] = -down;
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
