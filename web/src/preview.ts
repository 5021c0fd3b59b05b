/** Preview: the program's answer to a draft: what its checks say, and the way on which the vehicle would sail it. */
import { all, flag, isObject, number, points, words } from './json';
import type { Point } from './protocol';
import * as units from './units';

export interface PreviewLeg {
  /** Empty: no way leads to the point. */
  way: Point[];
  why: string;
  length: number;
  /** m from the hull to the nearest obstacle; absent: none is known. */
  margin: number | undefined;
  nearest: string;
  /** m in water that no map knows. */
  unknown: number;
  mayDrop: boolean;
}
export interface Preview {
  /** Why the mission would be refused; empty: it would not. */
  problem: string;
  legs: PreviewLeg[];
  /** m: the margin that the vehicle keeps where there is room. */
  clearance: number;
}

export function readPreview(json: unknown): Preview | null {
  if (!isObject(json)) return null;
  return {
    problem: words(json.problem),
    clearance: number(json.clearance_m) ?? 0,
    legs: all(json.legs, (v) =>
      isObject(v)
        ? {
            way: points(v.way_m),
            why: words(v.why),
            length: number(v.length_m) ?? 0,
            margin: number(v.margin_m),
            nearest: words(v.nearest),
            unknown: number(v.unknown_m) ?? 0,
            mayDrop: flag(v.may_drop),
          }
        : undefined,
    ),
  };
}

/** m: less than this in unknown water is not told. */
const kTold = 1;

/** What the list says of a leg. */
export function legText(leg: PreviewLeg, clearance: number): string {
  if (leg.way.length === 0) return `▲ No way: ${leg.why}`;
  const parts = [units.metres(leg.length)];
  if (leg.margin === undefined) parts.push('no obstacle is known there');
  else if (leg.margin < 0) parts.push(`▲ leads over or under ${leg.nearest}`);
  else parts.push(`${leg.margin < clearance - 0.1 ? '▲ ' : ''}margin ${units.metres(leg.margin)} to ${leg.nearest}`);
  if (leg.unknown >= kTold) parts.push(`${units.metres(Math.min(leg.unknown, leg.length))} in water that no map knows`);
  if (leg.mayDrop) parts.push('▲ an obstacle is so near to the point that the vehicle may give the point up');
  return parts.join('; ');
}

/** What the line above the list says of the whole draft. */
export function sumText({ problem, legs }: Preview): string {
  if (problem) return `▲ The vehicle would refuse this: ${problem}`;
  const reached = legs.filter(({ way }) => way.length > 0);
  const missing = legs.length - reached.length;
  const length = reached.reduce((sum, leg) => sum + leg.length, 0);
  const unknown = reached.reduce((sum, leg) => sum + leg.unknown, 0);
  const margins = reached.flatMap(({ margin }) => (margin === undefined ? [] : [margin]));
  const parts = [`${legs.length} point${legs.length === 1 ? '' : 's'}, ${units.metres(length)}`];
  parts.push(margins.length > 0 ? `least margin ${units.metres(Math.min(...margins))}` : 'no obstacle is known on the way');
  if (unknown >= kTold) parts.push(`${units.metres(Math.min(unknown, length))} in water that no map knows`);
  if (missing > 0) parts.push(`▲ no way to ${missing} point${missing === 1 ? '' : 's'}, which the vehicle would give up`);
  return parts.join('; ');
}
