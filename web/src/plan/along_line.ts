/**
 * What the maps know along a line: the least depth, the part of the line whose depth is unknown, and the nearest
 * obstacle. Unknown depth is not safe depth, so it is said. The line is sampled at every half metre, at least 200 times
 * and at most 2000 times.
 */
import type { Point } from '../protocol';
import { metres } from '../units';
import { distanceTo, type Tracked } from './obstacle_tracks';

const kStep = 0.5;

/** `depthAt`: null where the depth is unknown. An obstacle farther than `reach` from the line is not told, m. */
export function alongLine(
  from: Point,
  to: Point,
  depthAt: ((at: Point) => number | null) | null,
  obstacles: readonly Tracked[],
  reach: number,
): string[] {
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
  if (!(length > 0)) return [];
  const samples = Math.min(2000, Math.max(200, Math.ceil(length / kStep)));
  const place = (i: number): Point => {
    const share = i / samples;
    return [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])];
  };
  const at = (i: number) => metres((i / samples) * length);
  const parts: string[] = [];
  if (depthAt) {
    let [unknown, least, where] = [0, Infinity, 0];
    for (let i = 0; i <= samples; ++i) {
      const depth = depthAt(place(i));
      if (depth === null) ++unknown;
      else if (depth < least) [least, where] = [depth, i];
    }
    if (least < Infinity) parts.push(`least depth ${metres(least)}, ${at(where)} along`);
    if (unknown > samples) parts.push('depth unknown');
    else if (unknown > 0) parts.push(`depth unknown for ${metres((unknown / (samples + 1)) * length)}`);
  }
  let [nearest, least, where]: [Tracked | null, number, number] = [null, reach, 0];
  for (let i = 0; i <= samples; ++i) {
    for (const t of obstacles) {
      const far = distanceTo(t, place(i)).metres;
      if (far < least) [nearest, least, where] = [t, far, i];
    }
  }
  if (nearest) {
    const name = nearest.number === undefined ? 'an obstacle' : `obstacle ${nearest.number}`;
    parts.push(least > 0 ? `${name} ${metres(least)} beside it, ${at(where)} along` : `meets ${name} at ${at(where)}`);
  }
  return parts;
}
