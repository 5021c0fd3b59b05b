/** Values of parsed JSON, read without trust: of another type, a value is absent. */
import type { Point, Point3 } from './protocol';

export type Json = Record<string, unknown>;
export const isObject = (v: unknown): v is Json => typeof v === 'object' && v !== null && !Array.isArray(v);
export const list = (v: unknown): unknown[] => (Array.isArray(v) ? v : []);
export const number = (v: unknown): number | undefined => (typeof v === 'number' && Number.isFinite(v) ? v : undefined);
export const words = (v: unknown): string => (typeof v === 'string' ? v : '');
export const flag = (v: unknown): boolean => v === true;

export function point(v: unknown): Point | undefined {
  const [n, e] = [number(list(v)[0]), number(list(v)[1])];
  return n === undefined || e === undefined ? undefined : [n, e];
}
export function point3(v: unknown): Point3 | undefined {
  const at = point(v);
  return at && [at[0], at[1], number(list(v)[2]) ?? NaN];
}
export function all<T>(v: unknown, read: (entry: unknown) => T | undefined): T[] {
  return list(v)
    .map(read)
    .filter((entry): entry is T => entry !== undefined);
}
export const points = (v: unknown): Point[] => all(v, point);
export const outlines = (v: unknown): Point[][] =>
  list(v)
    .map(points)
    .filter((outline) => outline.length > 1);
export function counts(v: unknown): [string, number][] {
  if (!isObject(v)) return [];
  return Object.entries(v).filter((entry): entry is [string, number] => number(entry[1]) !== undefined);
}
/** Seconds from whole nanoseconds, which a double could not hold. */
export function seconds(nanoseconds: string): number {
  const ns = BigInt(nanoseconds);
  return Number(ns / 1_000_000_000n) + Number(ns % 1_000_000_000n) / 1e9;
}
