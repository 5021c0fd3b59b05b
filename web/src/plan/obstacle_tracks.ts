/**
 * Tracked: all that is known of one obstacle, which is its remembered state and its pieces in the last scan. Also finds
 * the obstacle at a position and describes it in words. Angles in rad, positions north and east in m.
 */
import type { Obstacle } from '../items';
import type { Point } from '../protocol';
import { age, bearing, metres, percent } from '../units';

export interface Tracked {
  /** None: seen by the last scan, but not yet remembered by the agents. */
  id: number | undefined;
  /** Outlines of the last scan, else the remembered one. */
  outlines: Point[][];
  remembered: Obstacle | undefined;
  seen: Obstacle[];
}

export function tracked(all: readonly Obstacle[]): Tracked[] {
  const known = new Map<number, Tracked>();
  for (const o of all) if (o.id !== undefined) known.set(o.id, { id: o.id, outlines: [], remembered: o, seen: [] });
  const rest: Tracked[] = [];
  for (const o of all) {
    if (o.id !== undefined) continue;
    const of = o.of === undefined ? undefined : known.get(o.of);
    if (of) of.seen.push(o);
    else rest.push({ id: undefined, outlines: [], remembered: undefined, seen: [o] });
  }
  const every = [...known.values(), ...rest];
  for (const t of every) {
    t.outlines = [...t.seen.map(({ outline }) => outline), t.remembered?.outline ?? []].filter((o) => o.length > 0);
  }
  return every.filter(({ outlines }) => outlines.length > 0);
}

/** The nearest obstacle within `reach` of a position, m; of equally near ones, the one with a number. */
export function trackedAt(all: readonly Tracked[], at: Point, reach: number): Tracked | null {
  let [best, least]: [Tracked | null, number] = [null, reach];
  for (const t of all) {
    const far = distanceTo(t, at).metres;
    if (far < least || (far === least && best?.id === undefined)) [best, least] = [t, far];
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

/** "Obstacle 3: known for 12 s, last seen 2.0 s ago, 14.2 m away, bearing 031°, margin 1.2 m". */
export function words(t: Tracked, now: number, vehicle: Point | null): string {
  const parts: string[] = [];
  const { remembered } = t;
  if (remembered) {
    if (remembered.since !== undefined) parts.push(`known for ${age(now - remembered.since)}`);
    if (remembered.seen !== undefined) parts.push(`last seen ${age(now - remembered.seen)} ago`);
  } else {
    parts.push('seen by the last scan, not yet remembered');
    if (t.seen[0]?.existence !== undefined) parts.push(`existence ${percent(t.seen[0].existence)}`);
  }
  const label = t.seen.find((o) => o.label !== undefined)?.label;
  if (label !== undefined) parts.push(kLabels[label]);
  if (vehicle) {
    const away = distanceTo(t, vehicle);
    parts.push(`${metres(away.metres)} away`, `bearing ${bearing(away.bearing)}`);
  }
  if (remembered) parts.push(`margin ${metres(remembered.margin)}`);
  return `${t.id === undefined ? 'Obstacle' : `Obstacle ${t.id}`}: ${parts.join(', ')}`;
}
