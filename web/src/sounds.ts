/** The sounds that the passive array hears, as the page gets them (docs/live-page.md). */
import { all, isObject, number, point, words } from './json';
import type { Point } from './protocol';

export interface Sound {
  number: number;
  /** Hz */
  frequency: number;
  /** rad, clockwise from north, and its standard deviation. */
  bearing: number;
  sigma: number;
  /** Where the vehicle was when it heard it last. */
  from: Point;
  /** What the sound comes from: the number of an obstacle, 0 for none that is known; undefined: not decided. */
  obstacle: number | undefined;
  probability: number;
  /** The nearest point of that obstacle, or the place where the bearings cross. */
  to: Point | undefined;
}

const radians = (degrees: number | undefined) => ((degrees ?? NaN) * Math.PI) / 180;

export function readSounds(json: unknown): Sound[] | null {
  if (!Array.isArray(json)) return null;
  return all(json, (v) => {
    if (!isObject(v)) return undefined;
    const [frequency, from] = [number(v.frequency_hz), point(v.from)];
    const bearing = radians(number(v.bearing_deg));
    if (frequency === undefined || from === undefined || !Number.isFinite(bearing)) return undefined;
    const origin = words(v.origin);
    return {
      number: number(v.number) ?? 0,
      frequency,
      bearing,
      sigma: radians(number(v.sigma_deg)),
      from,
      obstacle: origin === 'obstacle' ? number(v.obstacle) : origin === 'none' ? 0 : undefined,
      probability: number(v.probability) ?? NaN,
      to: point(v.to),
    };
  });
}

/** "120 Hz, obstacle 7", "63 Hz, no known obstacle", "300 Hz, origin unknown". */
export function soundText({ frequency, obstacle }: Sound): string {
  const origin =
    obstacle === undefined ? 'origin unknown' : obstacle === 0 ? 'no known obstacle' : `obstacle ${obstacle}`;
  return `${Number(frequency.toFixed(frequency < 1000 ? 1 : 0))} Hz, ${origin}`;
}
