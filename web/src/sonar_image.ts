/**
 * SonarImage: the newest samples of each beam of a sonar, for a whole fan or a whole turn of a scanning head, in the
 * sonar's order of beams, with the pose of the sensor for each beam.
 */
import type { Sonar } from './items';
import type { Echoes } from './protocol';

export class SonarImage {
  readonly beams: number;
  readonly bins: number;
  /** Samples, beam after beam, the nearest bin first. */
  readonly intensity: Uint8Array;
  /** 1: the sample was detected as an echo. */
  readonly decided: Uint8Array;
  /** Seven numbers a beam: north, east, down of the sensor; w, x, y, z of its rotation to W. */
  readonly poses: Float64Array;
  /** Time of each beam, s since 1970; NaN: no ping yet. */
  readonly heard: Float64Array;
  /** Grows with each change of a beam. */
  readonly revisions: Uint32Array;
  revision = 0;
  newest = -1;
  time = NaN;

  constructor(
    readonly sonar: Sonar,
    before?: SonarImage,
  ) {
    this.beams = sonar.azimuth.length;
    this.bins = sonar.bins;
    // A sonar that only changes its scale keeps its samples.
    const same = before && before.beams === this.beams && before.bins === this.bins ? before : undefined;
    this.intensity = same?.intensity ?? new Uint8Array(this.beams * this.bins);
    this.decided = same?.decided ?? new Uint8Array(this.beams * this.bins);
    this.poses = same?.poses ?? new Float64Array(this.beams * 7);
    this.heard = same?.heard ?? new Float64Array(this.beams).fill(NaN);
    this.revisions = same?.revisions ?? new Uint32Array(this.beams);
    this.revision = (same?.revision ?? 0) + 1;
    this.newest = same?.newest ?? -1;
    this.time = same?.time ?? NaN;
  }

  /** False: the echoes do not fit this sonar. */
  take(echoes: Echoes, time: number): boolean {
    const { first, beams, bins } = echoes;
    if (bins !== this.bins || first + beams > this.beams) return false;
    ++this.revision;
    this.intensity.set(echoes.intensity, first * bins);
    const samples = beams * bins;
    const from = first * bins;
    for (let i = 0; i < samples; ++i) this.decided[from + i] = (echoes.decided[i >> 3]! >> (i & 7)) & 1;
    for (let beam = first; beam < first + beams; ++beam) {
      this.poses.set(echoes.place, beam * 7);
      this.poses.set(echoes.rotation, beam * 7 + 3);
      this.heard[beam] = time;
      this.revisions[beam] = this.revision;
    }
    this.newest = first + beams - 1;
    this.time = time;
    return true;
  }

  clear(beam: number): void {
    if (beam >= this.beams) return;
    this.intensity.fill(0, beam * this.bins, (beam + 1) * this.bins);
    this.decided.fill(0, beam * this.bins, (beam + 1) * this.bins);
    this.heard[beam] = NaN;
    this.revisions[beam] = ++this.revision;
  }

  /** Range of the far side of the last bin, m. */
  get reach(): number {
    return this.sonar.first + this.sonar.bin * this.bins;
  }
  rangeOf(bin: number): number {
    return this.sonar.first + (bin + 0.5) * this.sonar.bin;
  }
  valueOf(byte: number): number {
    const { low, high } = this.sonar.scale;
    return low + ((high - low) * byte) / 255;
  }
  /** Direction of a beam in W. */
  direction(beam: number, out: Float64Array): void {
    const at = beam * 7 + 3;
    const azimuth = this.sonar.azimuth[beam]!;
    const p = this.poses;
    turn(p[at]!, p[at + 1]!, p[at + 2]!, p[at + 3]!, Math.cos(azimuth), Math.sin(azimuth), out);
  }
  /** Elevation above the horizon, rad, of an azimuth in the plane of the fan, at its last pose. */
  elevation(azimuth: number): number {
    const at = Math.max(0, this.newest) * 7 + 3;
    const p = this.poses;
    const out = new Float64Array(3);
    turn(p[at]!, p[at + 1]!, p[at + 2]!, p[at + 3]!, Math.cos(azimuth), Math.sin(azimuth), out);
    return Math.asin(Math.max(-1, Math.min(1, -out[2]!)));
  }
}

/** Rotates (x, y, 0) by a unit quaternion. */
export function turn(w: number, i: number, j: number, k: number, x: number, y: number, out: Float64Array): void {
  out[0] = (1 - 2 * (j * j + k * k)) * x + 2 * (i * j - w * k) * y;
  out[1] = 2 * (i * j + w * k) * x + (1 - 2 * (i * i + k * k)) * y;
  out[2] = 2 * (i * k - w * j) * x + 2 * (j * k + w * i) * y;
}
