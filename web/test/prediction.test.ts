import { describe, expect, it } from 'vitest';
import { readDecision, readObstacles, type Covariance } from '../src/items';
import { passing } from '../src/log';
import { Model } from '../src/model';
import { ellipse, greatestDeviation, growth, meeting, predicted, planned, speeds } from '../src/plan/prediction';
import { moversOf } from '../src/plan/prediction_layer';
import type { Point } from '../src/protocol';
import { speedWords } from '../src/speed_chart';

const square = (n: number, e: number): Point[] => [
  [n - 1, e - 1],
  [n + 1, e - 1],
  [n + 1, e + 1],
  [n - 1, e + 1],
];
const piece = (said: object) => readObstacles({ pieces: [{ number: 4, outline: square(10, 0), ...said }] })!.pieces[0]!;
const range = (outline: readonly Point[], k: 0 | 1): [number, number] => [
  Math.min(...outline.map((p) => p[k])),
  Math.max(...outline.map((p) => p[k])),
];

describe('a body that moves', () => {
  const body = piece({ velocity: [0.5, -1], covariance_m2: [0.09, 0, 0.04], velocity_covariance: [0.01, 0, 0.0025] });

  it('is read with its covariances, which older recordings lack', () => {
    expect(body.covariance).toEqual([0.09, 0, 0.04]);
    expect(body.velocityCovariance).toEqual([0.01, 0, 0.0025]);
    expect(piece({ velocity: [1, 0], covariance_m2: [1, null, 1] }).covariance).toBeUndefined();
  });

  it('grows by what its place deviates more than now, in the direction in which that is greatest', () => {
    expect(greatestDeviation([2, 2, 5])).toBeCloseTo(Math.sqrt(6), 12); // eigenvalues 1 and 6
    expect(growth(body, 0)).toBe(0);
    expect(growth(body, 10)).toBeCloseTo(Math.sqrt(0.09 + 1) - 0.3, 12);
    expect(growth(piece({ velocity: [1, 0] }), 20)).toBe(0);
  });

  it('is predicted by its velocity, its outline grown', () => {
    const then = predicted(body, 10);
    const by = Math.sqrt(1.09) - 0.3;
    expect(range(then, 0)[0]).toBeCloseTo(10 + 5 - 1 - by, 6);
    expect(range(then, 0)[1]).toBeCloseTo(10 + 5 + 1 + by, 6);
    expect(range(then, 1)[0]).toBeCloseTo(-10 - 1 - by, 6);
    expect(range(then, 1)[1]).toBeCloseTo(-10 + 1 + by, 6);
    expect(predicted(piece({ velocity: [1, 0] }), 5)).toHaveLength(4);
    expect(predicted(piece({}), 5)).toEqual([]);
  });

  it('has an ellipse of the deviation of its place', () => {
    const c: Covariance = [2, 2, 5];
    for (const [n, e] of ellipse([3, 4], c, 2)) {
      const [x, y] = [n - 3, e - 4];
      expect((5 * x * x - 4 * x * y + 2 * y * y) / 6).toBeCloseTo(4, 9); // by the inverse of c: two deviations
    }
  });

  it('is drawn with more than its arrow only near the vehicle, or if a decision is about it', () => {
    const model = new Model();
    model.pieces = [piece({ velocity: [1, 0] }), piece({ velocity: [1, 0], outline: square(60, 0) }), piece({})];
    expect(moversOf(model, null)).toHaveLength(2);
    model.vehicle = { north: 0, east: 0 } as Model['vehicle'];
    expect(moversOf(model, null)).toEqual([model.pieces[0]]);
    const said = { approach: { in_s: 1, gap_m: 1 }, way_m: square(0, 0), obstacle: 9 };
    model.pieces.push(piece({ number: 9, velocity: [1, 0], outline: square(60, 0) }));
    expect(moversOf(model, readDecision(said, 1, 0)).map(({ number }) => number)).toEqual([9]);
    expect(moversOf(model, readDecision({ ...said, approach: {} }, 1, 0))).toHaveLength(1);
  });
});

describe('a decision that tells of a closest approach', () => {
  const decided = (said: object) => readDecision({ agent: 'goal selector', what: 'plan', ...said }, 3, 100)!;
  const way = [0, 1.5, 3, 4, 4.5, 5.5, 7].map((n): Point => [n, 0]);
  const approach = { in_s: 3.5, gap_m: 1.46, obstacle_m: [4, 3] };

  it('says in its row how near the body passes, and when', () => {
    expect(passing(decided({ approach }).approach!)).toBe('passes at 1.5 m in 3.5 s');
    expect(passing({ in: 12.2, gap: -0.1, body: undefined })).toBe('would touch in 12 s');
    expect(decided({ approach: { in_s: 1 } }).approach).toBeUndefined();
    expect(decided({}).approach).toBeUndefined();
  });

  it('says where the vehicle and the body will be then', () => {
    expect(meeting(decided({ approach, way_m: way }))).toEqual({ vehicle: [4.25, 0], body: [4, 3] });
    const at = (seconds: number) => meeting(decided({ approach: { in_s: seconds, gap_m: 1 }, way_m: way }));
    expect(at(6)).toEqual({ vehicle: [7, 0], body: undefined });
    expect(at(6.5)).toEqual({ vehicle: [7.75, 0], body: undefined });
    expect(at(30)).toBeNull();
    expect(meeting(decided({ way_m: way }))).toBeNull();
    expect(meeting(decided({ approach }))).toBeNull();
  });

  it('has a plan with a place each second, and so its speeds', () => {
    expect(planned(way)).toBe(6);
    expect(speeds(way).map(({ at, speed }) => [at, speed])).toEqual([
      [0.5, 1.5],
      [1.5, 1.5],
      [2.5, 1],
      [3.5, 0.5],
      [4.5, 1],
      [5.5, 1.5],
    ]);
    expect(speedWords(way)).toBe('1.50 m/s at first, lowest 0.50 m/s after 3.5 s, 1.50 m/s at the end');
    expect(speedWords(way.slice(0, 2))).toBe('1.50 m/s at first, 1.50 m/s at the end');
  });
});
