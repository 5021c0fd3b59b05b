/**
 * Tracked: all that is known of one obstacle, which is what the scan and the agents say of it as a whole, its pieces in
 * the last scan, and its remembered pieces. Also finds the obstacle at a position and describes it in words. Angles in
 * rad, positions north and east in m.
 */
import type { Obstacle, Obstacles, Piece } from '../items';
import type { Point } from '../protocol';
import { age, bearing, metres, percent } from '../units';
import { greatestDeviation } from './prediction';

export interface Tracked {
  /** None: a piece that belongs to no numbered obstacle. */
  number: number | undefined;
  /** Kind and extent; none in recordings of older programs. */
  whole: Obstacle | undefined;
  /** Outlines of the last scan, then remembered ones. */
  outlines: Point[][];
  remembered: Piece[];
  seen: Piece[];
}

/** In the order of the list, nearest first at the last scan; then what only pieces tell of. */
export function tracked({ obstacles, pieces }: Obstacles): Tracked[] {
  const known = new Map<number, Tracked>();
  const start = (number: number | undefined, whole?: Obstacle): Tracked => ({
    number,
    whole,
    outlines: [],
    remembered: [],
    seen: [],
  });
  for (const whole of obstacles) known.set(whole.number, start(whole.number, whole));
  const rest: Tracked[] = [];
  for (const piece of pieces) {
    // Older programs number the remembered pieces only.
    const number = piece.number ?? piece.id ?? piece.of;
    const t = (number === undefined ? undefined : known.get(number)) ?? start(number);
    if (number === undefined) rest.push(t);
    else known.set(number, t);
    (piece.id === undefined ? t.seen : t.remembered).push(piece);
  }
  const every = [...known.values(), ...rest];
  for (const t of every) t.outlines = [...t.seen, ...t.remembered].map((p) => p.outline).filter((o) => o.length > 0);
  return every.filter(({ outlines }) => outlines.length > 0);
}

/** The nearest obstacle within `reach` of a position, m; of equally near ones, the one with a number. */
export function trackedAt(all: readonly Tracked[], at: Point, reach: number): Tracked | null {
  let [best, least]: [Tracked | null, number] = [null, reach];
  for (const t of all) {
    const far = distanceTo(t, at).metres;
    if (far < least || (far === least && best?.number === undefined)) [best, least] = [t, far];
  }
  return best;
}

/** Distance and bearing to the nearest point of its outlines; distance 0 inside. */
export function distanceTo({ outlines }: Tracked, from: Point): { metres: number; bearing: number } {
  let nearest: Point = [NaN, NaN];
  let least = Infinity;
  for (const outline of outlines) {
    if (holds(outline, from)) return { metres: 0, bearing: NaN };
    outline.forEach((a, i) => {
      const p = nearestOf(a, outline[(i + 1) % outline.length]!, from);
      const far = Math.hypot(p[0] - from[0], p[1] - from[1]);
      if (far < least) [nearest, least] = [p, far];
    });
  }
  return { metres: least, bearing: Math.atan2(nearest[1] - from[1], nearest[0] - from[0]) };
}

function nearestOf(a: Point, b: Point, p: Point): Point {
  const [n, e] = [b[0] - a[0], b[1] - a[1]];
  const squared = n * n + e * e;
  const share = squared > 0 ? ((p[0] - a[0]) * n + (p[1] - a[1]) * e) / squared : 0;
  const along = Math.min(1, Math.max(0, share));
  return [a[0] + along * n, a[1] + along * e];
}

function holds(outline: readonly Point[], [n, e]: Point): boolean {
  let inside = false;
  outline.forEach((a, i) => {
    const b = outline[(i + 1) % outline.length]!;
    if (a[1] > e !== b[1] > e && n < a[0] + ((e - a[1]) / (b[1] - a[1])) * (b[0] - a[0])) inside = !inside;
  });
  return inside;
}

const kLabels = { standing: 'stands in the water', bottom: 'bottom', surface: 'surface' };

/** When the agents saw it last, s since the start; undefined: they do not remember it. */
export const lastSeen = ({ whole, remembered }: Tracked): number | undefined =>
  whole ? whole.seen : greatest(remembered.map(({ seen }) => seen));
const firstSeen = ({ whole, remembered }: Tracked): number | undefined =>
  whole ? whole.since : least(remembered.map(({ since }) => since));

/** How far it may extend beyond its outlines by now, m; 0 if the agents do not remember it. */
export const marginOf = ({ remembered }: Tracked): number => Math.max(0, ...remembered.map(({ margin }) => margin));

/** "Obstacle 3", "compact, 0.8 m across". */
export const nameOf = ({ number }: Tracked): string => (number === undefined ? 'Obstacle' : `Obstacle ${number}`);
export const sizeOf = ({ whole }: Tracked): string =>
  whole?.extent === undefined ? (whole?.kind ?? '') : `${whole.kind}, ${metres(whole.extent)} across`;

/** How long it has been known, and what is sure about it: "known for 12 s", "last seen 2.0 s ago". */
export function history(t: Tracked, now: number): string[] {
  const parts: string[] = [];
  const [since, seen] = [firstSeen(t), lastSeen(t)];
  if (t.remembered.length > 0 || since !== undefined) {
    if (since !== undefined) parts.push(`known for ${age(now - since)}`);
    if (seen !== undefined) parts.push(`last seen ${age(now - seen)} ago`);
  } else {
    parts.push('seen by the last scan, not yet remembered');
    const existence = t.whole?.existence ?? t.seen[0]?.existence;
    if (existence !== undefined) parts.push(`existence ${percent(existence)}`);
  }
  const { velocity, velocityCovariance } = t.seen.find((o) => o.velocity !== undefined) ?? {};
  if (velocity) {
    const course = bearing(Math.atan2(velocity[1], velocity[0]));
    const sure = velocityCovariance ? ` ± ${greatestDeviation(velocityCovariance).toFixed(1)}` : '';
    parts.push(`moves at ${Math.hypot(...velocity).toFixed(1)}${sure} m/s towards ${course}`);
  }
  const label = t.seen.find((o) => o.label !== undefined)?.label;
  if (label !== undefined) parts.push(kLabels[label]);
  if (t.whole?.behind) parts.push('behind a nearer one');
  return parts;
}

/** "Obstacle 3: compact, 0.8 m across, known for 12 s, last seen 2.0 s ago, 14.2 m away, bearing 031°". */
export function words(t: Tracked, now: number, vehicle: Point | null): string {
  const parts = [sizeOf(t), ...history(t, now)].filter((part) => part !== '');
  if (vehicle) {
    const away = distanceTo(t, vehicle);
    parts.push(`${metres(away.metres)} away`, `bearing ${bearing(away.bearing)}`);
  }
  if (t.remembered.length > 0) parts.push(`margin ${metres(marginOf(t))}`);
  return `${nameOf(t)}: ${parts.join(', ')}`;
}

const known = (values: (number | undefined)[]): number[] => values.filter((v): v is number => v !== undefined);
const least = (values: (number | undefined)[]): number | undefined => {
  const all = known(values);
  return all.length > 0 ? Math.min(...all) : undefined;
};
const greatest = (values: (number | undefined)[]): number | undefined => {
  const all = known(values);
  return all.length > 0 ? Math.max(...all) : undefined;
};
