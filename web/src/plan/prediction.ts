/**
 * Prediction: where a body that moves will be if it keeps its velocity, and how sure that is. North and east in m, m/s.
 *
 * P and V are the covariances of the position and of the velocity. The present outline includes the greatest standard
 * deviation of P; the outline t seconds ahead includes that of P + t² V. The Goal Selector grows an outline by t times
 * the greatest standard deviation of V, and bounds the growth (`goal_selector.max_growth_m`).
 */
import type { Covariance, Decision, Piece } from '../items';
import type { Point } from '../protocol';

/** s: the times ahead at which a body is drawn. */
export const kAhead = [5, 10, 15, 20] as const;
const kCorners = 16;
const kExact: Covariance = [0, 0, 0];

/** Standard deviation along the direction in which it is greatest. */
export function greatestDeviation([nn, ne, ee]: Covariance): number {
  return Math.sqrt(Math.max(0, 0.5 * (nn + ee) + Math.hypot(0.5 * (nn - ee), ne)));
}

/** The ellipse of `sigmas` standard deviations about a place. */
export function ellipse([north, east]: Point, [nn, ne, ee]: Covariance, sigmas: number): Point[] {
  const greater = greatestDeviation([nn, ne, ee]);
  const lesser = Math.sqrt(Math.max(0, nn + ee - greater * greater));
  const along = 0.5 * Math.atan2(2 * ne, nn - ee);
  const [c, s] = [Math.cos(along), Math.sin(along)];
  return Array.from({ length: 2 * kCorners }, (_, i): Point => {
    const angle = (Math.PI * i) / kCorners;
    const [a, b] = [sigmas * greater * Math.cos(angle), sigmas * lesser * Math.sin(angle)];
    return [north + a * c - b * s, east + a * s + b * c];
  });
}

/** m: by how much the outline of a body grows within `ahead` s; 0 if its covariances are unknown. */
export function growth({ covariance, velocityCovariance }: Piece, ahead: number): number {
  const [p, v] = [covariance ?? kExact, velocityCovariance ?? kExact];
  const squared = ahead * ahead;
  const then: Covariance = [p[0] + squared * v[0], p[1] + squared * v[1], p[2] + squared * v[2]];
  return greatestDeviation(then) - greatestDeviation(p);
}

/** The outline of a body `ahead` s from now; empty if it is not known to move. */
export function predicted(piece: Piece, ahead: number): Point[] {
  const { outline, velocity } = piece;
  if (!velocity || outline.length === 0) return [];
  const by = growth(piece, ahead);
  return hull(
    outline.flatMap(([n, e]) =>
      Array.from({ length: kCorners }, (_, i): Point => {
        const angle = (2 * Math.PI * i) / kCorners;
        return [n + ahead * velocity[0] + by * Math.cos(angle), e + ahead * velocity[1] + by * Math.sin(angle)];
      }),
    ),
  );
}

/** The convex hull (Andrew's monotone chain). */
function hull(points: readonly Point[]): Point[] {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (from: readonly Point[]): Point[] => {
    const chain: Point[] = [];
    for (const p of from) {
      while (chain.length > 1 && !turns(chain[chain.length - 2]!, chain[chain.length - 1]!, p)) chain.pop();
      chain.push(p);
    }
    return chain.slice(0, -1);
  };
  return [...half(sorted), ...half([...sorted].reverse())];
}
const turns = (a: Point, b: Point, c: Point): boolean =>
  (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 1e-12;

/** s between the places of a plan (docs/live-page.md). */
const kPlanStep = 1;

/** Whether the way of a decision is a plan over time, with a place a second, not a route. */
export const isPlan = ({ approach, way }: Decision): boolean => approach !== undefined && way.length > 1;

/** The planned place `at` s after the decision. The plan may end within a second after its last place, not later. */
export function plannedPlace(way: readonly Point[], at: number): Point | undefined {
  const steps = Math.max(0, at / kPlanStep);
  const before = Math.min(Math.floor(steps), way.length - 2);
  const share = steps - before;
  const [a, b] = [way[before], way[before + 1]];
  if (!a || !b || share > 2) return undefined;
  return [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
}

export interface Meeting {
  /** Of the vehicle and of the body at the closest approach; the body's is absent if it is unknown. */
  vehicle: Point;
  body: Point | undefined;
}
export function meeting(decision: Decision): Meeting | null {
  const { approach, way } = decision;
  if (!approach || !isPlan(decision)) return null;
  const vehicle = plannedPlace(way, approach.in);
  return vehicle ? { vehicle, body: approach.body } : null;
}

/** Planned speeds: s after the decision, and m/s, one for each second. */
export function speeds(way: readonly Point[]): { at: number; speed: number }[] {
  return way.slice(1).map((p, i) => ({
    at: (i + 0.5) * kPlanStep,
    speed: Math.hypot(p[0] - way[i]![0], p[1] - way[i]![1]) / kPlanStep,
  }));
}

/** s: how far ahead a plan reaches. */
export const planned = (way: readonly Point[]): number => (way.length - 1) * kPlanStep;
