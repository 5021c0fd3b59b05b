/** The command in force at each level, as the page gets it (docs/live-page.md). */
import { all, isObject, number, words } from './json';

export interface Level {
  level: string;
  command: string;
  /** The agent that gave it. */
  by: string;
  /** s since 1970 */
  since: number;
  /** Whether it serves a command of the level above. */
  serves: boolean;
  /** How far ahead the level plans, s; 0: it has nothing to plan. */
  horizon: number;
  /** Where the vehicle is in its plan graph; empty: the level has none. */
  plan: string;
}

export function readLevels(json: unknown): Level[] | null {
  if (!Array.isArray(json)) return null;
  return all(json, (v) => {
    if (!isObject(v)) return undefined;
    const [level, command, by, since] = [words(v.level), words(v.command), words(v.by), number(v.since_ns)];
    if (!level || command === undefined || !by) return undefined;
    return {
      level,
      command,
      by,
      since: since === undefined ? NaN : since / 1e9,
      serves: (number(v.parent) ?? 0) > 0,
      horizon: number(v.horizon_s) ?? 0,
      plan: words(v.plan) ?? '',
    };
  });
}

/** "captain, for 12 s; plans 300 s ahead"; "safety officer, for 3 s, a reflex or a stop". */
export function levelNote({ by, serves, level, horizon }: Level, ago: string): string {
  const reflex = !serves && level === 'primitive' ? ', a reflex or a stop' : '';
  const ahead = horizon > 0 ? `; plans ${Math.round(horizon)} s ahead` : '';
  return `${ago ? `${by}, for ${ago}` : by}${reflex}${ahead}`;
}
