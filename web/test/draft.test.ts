import { expect, test } from 'vitest';
import { readScene, type Scene } from '../src/items';
import { Draft, kMostPoints } from '../src/plan/draft';
import { legText, readPreview, sumText } from '../src/preview';

const scene = readScene({
  mission_number: 3,
  mission_speed: 1.5,
  fence: [[0, 0], [0, 100], [100, 100], [100, 0]],
  mission: [{ name: 'a', at: [10, 20], depth_m: 4 }, { at: [30, 40], altitude_m: 2, speed: 0.5 }],
}) as Scene;

test('a draft begins as the mission and states only what was edited', () => {
  const draft = new Draft(scene, true, 1);
  expect(draft.json()).toEqual({
    mission: 3,
    points: [
      { north: 10, east: 20, depth_m: 4, from: 0 },
      { north: 30, east: 40, altitude_m: 2, speed: 0.5, from: 1 },
    ],
  });
  expect(draft.add([1.234, 5])).toBe(2);
  expect(draft.json().points[2]).toEqual({ north: 1.23, east: 5, altitude_m: 2 });
  draft.remove(0);
  draft.set(0, { altitude: undefined, depth: 6 });
  expect(draft.json().points).toEqual([
    { north: 30, east: 40, depth_m: 6, speed: 0.5, from: 1 },
    { north: 1.23, east: 5, altitude_m: 2 },
  ]);
});

test('each change can be undone; a drag is one change', () => {
  const draft = new Draft(scene, true, 1);
  draft.lift();
  for (let n = 0; n < 5; ++n) draft.set(0, { at: [n, 0] });
  draft.drop();
  draft.remove(1);
  expect(draft.points.length).toBe(1);
  draft.undo();
  expect(draft.points.length).toBe(2);
  draft.undo();
  expect(draft.points[0]!.at).toEqual([10, 20]);
  expect(draft.canUndo).toBe(false);
});

test('a corner of the fence stands between the ends of the nearest side', () => {
  const draft = new Draft(scene, true, 1);
  expect(draft.json().fence).toBeUndefined();
  expect(draft.addCorner([95, 50])).toBe(3);
  expect(draft.fence).toEqual([[0, 0], [0, 100], [100, 100], [95, 50], [100, 0]]);
  draft.removeCorner(3);
  draft.setCorner(0, [-5, -5]);
  expect(draft.json().fence).toEqual([[-5, -5], [0, 100], [100, 100], [100, 0]]);
});

test('a single place has the depth of the last point of the mission, and a draft is bounded', () => {
  const draft = new Draft(scene, false, 1);
  draft.add([0, 0]);
  expect(draft.json().points).toEqual([{ north: 0, east: 0, altitude_m: 2 }]);
  while (draft.points.length < kMostPoints) draft.add([0, 0]);
  expect(draft.add([0, 0])).toBe(-1);
});

test('a preview says length, margin, unknown water, and where there is no way', () => {
  const preview = readPreview({
    clearance_m: 3,
    legs: [
      { way_m: [[0, 0], [10, 0]], length_m: 10, margin_m: 2, nearest: 'obstacle 4 at north 5.0, east 2.0 m', unknown_m: 4, why: 'clear' },
      { why: 'no path' },
    ],
  })!;
  expect(legText(preview.legs[0]!, preview.clearance)).toBe(
    '10.0 m; ▲ margin 2.0 m to obstacle 4 at north 5.0, east 2.0 m; 4.0 m in water that no map knows',
  );
  expect(legText(preview.legs[1]!, 3)).toBe('▲ No way: no path');
  expect(sumText(preview)).toMatch(/^2 points, 10.0 m; least margin 2.0 m; 4.0 m in water .*; ▲ no way to 1 point,/);
  expect(sumText(readPreview({ problem: 'too deep' })!)).toBe('▲ The vehicle would refuse this: too deep');
});
