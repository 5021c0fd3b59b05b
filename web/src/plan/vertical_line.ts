/**
 * VerticalLine: the samples of a vertical fan, seen from above. All its beams lie above one line, so that each sample is
 * shown on that line at its horizontal distance; of all heights the strongest sample is shown.
 */
import type { SonarImage } from '../sonar_image';

const kCells = 160;
/** Beams with a smaller horizontal component do not define the direction of the line. */
const kLeastAside = 0.02;

export interface VerticalLine {
  /** Position of the sensor. */
  north: number;
  east: number;
  /** Direction of the line, clockwise from north. */
  heading: number;
  /** Ends of the samples along the line, m; `from` is negative if beams look back. */
  from: number;
  to: number;
  /** Half the opening angle of the wedge that the beams cover, seen from above. */
  half: number;
  /** Strongest sample in each of equal cells from `from` to `to`; -1: no sample. */
  levels: Int16Array;
}

/** null: there is no sample, or all beams look straight up or down. */
export function verticalLine(image: SonarImage): VerticalLine | null {
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
  // each beam of a scanning head has a position of its own
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
