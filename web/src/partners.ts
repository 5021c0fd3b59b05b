/** The other vehicles of the group, as the vehicle last heard from them (docs/live-page.md). */
import { flag, isObject, number, point } from './json';
import type { Point } from './protocol';

export interface Partner {
  at: Point;
  /** s since 1970 */
  heard: number;
  /** From 1; of the lane that it sails. */
  lane: number | undefined;
  /** Whether its mission has ended. */
  over: boolean;
}

export function readPartner(json: unknown, time: number): Partner | null {
  const at = isObject(json) ? point(json.at) : undefined;
  if (!isObject(json) || !at) return null;
  return { at, heard: time, lane: number(json.lane), over: flag(json.over) };
}

/** "bravo, lane 5, 12 s ago". */
export function partnerNote(name: string, { lane, over }: Partner, ago: string): string {
  const does = over ? ', at rest' : lane === undefined ? '' : `, lane ${lane}`;
  return `${name}${does}${ago ? `, ${ago} ago` : ''}`;
}
