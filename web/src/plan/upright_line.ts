/**
 * What a fan that stands upright hears, seen from above: all its beams look along one line, so its samples are told
 * along that line by their horizontal distance, the strongest of all heights at each.
 */
import type { SonarImage } from '../sonar_image';

const kCells = 160;
/** Beams that look less than this aside of the vertical say nothing of where the line leads. */
const kLeastAside = 0.02;

export interface UprightLine {
  /** Where the sensor stood. */
  north: number;
  east: number;
  /** Of the line, clockwise from north. */
  heading: number;
  /** m along the line that were heard: `from` is negative where beams look back. */
  from: number;
  to: number;
  /** Half the angle of the wedge that the beams cover from above. */
  half: number;
  /** Strongest sample of each of equal stretches from `from` to `to`; -1: no sample lies there. */
  levels: Int16Array;
}

/** null: nothing was heard, or all beams look straight up or down. */
export function uprightLine(image: SonarImage): UprightLine | null {
  const { newest, beams, bins, heard, poses, intensity } = image;
  if (newest < 0) return null;
  const along = new Float64Array(3);
  const lean = new Float32Array(2 * beams);
  let widest = kLeastAside;
  let heading = NaN;
  for (let beam = 0; beam < beams; ++beam) {
    if (Number.isNaN(heard[beam]!)) continue;
    image.direction(beam, along);
    const [n, e] = [along[0]!, along[1]!];
    lean.set([n, e], 2 * beam);
    if (Math.hypot(n, e) > widest) [widest, heading] = [Math.hypot(n, e), Math.atan2(e, n)];
  }
  if (Number.isNaN(heading)) return null;
  const [north, east] = [poses[7 * newest]!, poses[7 * newest + 1]!];
  const [cos, sin] = [Math.cos(heading), Math.sin(heading)];
  const line = { north, east, heading, from: Infinity, to: -Infinity, half: image.sonar.height / 2 };
  // of a turning head each beam was heard from a place of its own
  const start = (beam: number) => (poses[7 * beam]! - north) * cos + (poses[7 * beam + 1]! - east) * sin;
  const aside = (beam: number) => lean[2 * beam]! * cos + lean[2 * beam + 1]! * sin;
  for (let beam = 0; beam < beams; ++beam) {
    if (Number.isNaN(heard[beam]!)) continue;
    for (const range of [image.sonar.first, image.reach]) {
      const at = start(beam) + range * aside(beam);
      line.from = Math.min(line.from, at);
      line.to = Math.max(line.to, at);
    }
  }
  const levels = new Int16Array(kCells).fill(-1);
  const cells = kCells / Math.max(1e-6, line.to - line.from);
  for (let beam = 0; beam < beams; ++beam) {
    if (Number.isNaN(heard[beam]!)) continue;
    const from = (start(beam) - line.from + image.rangeOf(0) * aside(beam)) * cells;
    const step = image.sonar.bin * aside(beam) * cells;
    for (let bin = 0; bin < bins; ++bin) {
      const cell = Math.min(kCells - 1, Math.max(0, Math.floor(from + bin * step)));
      const level = intensity[beam * bins + bin]!;
      if (level > levels[cell]!) levels[cell] = level;
    }
  }
  return { ...line, levels };
}
