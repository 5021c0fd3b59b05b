import { describe, expect, it } from 'vitest';
import * as encode from '../fixtures/encode';
import { EchoTrail } from '../src/echo_trail';
import { readSonar } from '../src/items';
import { verticalLine } from '../src/plan/vertical_line';
import { readEchoes, type Echoes } from '../src/protocol';
import { directionText } from '../src/sonar/sample';
import { SonarImage } from '../src/sonar_image';

const kDegree = Math.PI / 180;
const kRolled = Math.SQRT1_2; // a quarter turn to starboard: the y axis of the sensor looks down
const sonar = (more: object = {}) =>
  readSonar({
    name: 'stave',
    upright: true,
    azimuth: [-60 * kDegree, 0, 60 * kDegree],
    width: [0.1, 0.1, 0.1],
    height: 0.2,
    first_m: 0,
    bin_m: 1,
    bins: 20,
    ...more,
  })!;

/** One ping of `beams` beams from the first one on, with a level at one bin of each. */
function heard(first: number, bins: number[], rotation: number[], place = [0, 0, 2]): Echoes {
  const intensity = new Uint8Array(20 * bins.length);
  const decided = new Uint8Array(20 * bins.length);
  bins.forEach((bin, beam) => {
    intensity[20 * beam + bin] = 100 + beam;
    decided[20 * beam + bin] = 1;
  });
  const bytes = encode.echoesBytes({ beams: bins.length, bins: 20, place, rotation, intensity, decided });
  return readEchoes(new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength), first)!;
}
const north = [kRolled, kRolled, 0, 0];
const east = [0.5, 0.5, 0.5, 0.5]; // turned to the east, then rolled

function image(echoes: Echoes, more: object = {}): SonarImage {
  const made = new SonarImage(sonar(more));
  expect(made.take(echoes, 1)).toBe(true);
  return made;
}
/** m along the line of the level; NaN: nowhere. */
function placeOf(line: NonNullable<ReturnType<typeof verticalLine>>, level: number): number {
  const cell = line.levels.indexOf(level);
  return cell < 0 ? NaN : line.from + ((cell + 0.5) / line.levels.length) * (line.to - line.from);
}

describe('a fan that stands upright, seen from above', () => {
  it('is a line where the fan looks, as long as its beams reach beside the vehicle', () => {
    const line = verticalLine(image(heard(0, [3, 3, 3], north)))!;
    expect(line.heading).toBeCloseTo(0, 6);
    expect([line.from, line.to]).toEqual([0, 20].map((m) => expect.closeTo(m, 4)));
    expect(line.half).toBeCloseTo(0.1, 6);
    expect(verticalLine(image(heard(0, [3, 3, 3], east)))!.heading).toBeCloseTo(Math.PI / 2, 6);
  });

  it('has an echo at its horizontal distance, not at its range', () => {
    const line = verticalLine(image(heard(0, [9, 15, 17], north)))!;
    expect(placeOf(line, 100)).toBeCloseTo(9.5 * Math.cos(60 * kDegree), 0);
    expect(placeOf(line, 101)).toBeCloseTo(15.5, 0);
    expect(placeOf(line, 102)).toBeCloseTo(17.5 * Math.cos(60 * kDegree), 0);
  });

  it('shows of several heights the strongest, and nothing where no beam was heard', () => {
    const made = new SonarImage(sonar({ azimuth: [0, 10 * kDegree, 20 * kDegree] }));
    expect(verticalLine(made)).toBeNull();
    made.take(heard(0, [5, 5], north), 1);
    const line = verticalLine(made)!;
    expect(Math.max(...line.levels)).toBe(101);
    expect(placeOf(line, 102)).toBeNaN();
  });

  it('leads behind the sensor where beams look back, and nowhere where all look straight down', () => {
    const down = image(heard(0, [4, 4, 4], north), { azimuth: [30, 90, 150].map((d) => d * kDegree) });
    const line = verticalLine(down)!;
    expect(line.from).toBeCloseTo(-20 * Math.cos(30 * kDegree), 4);
    expect(line.to).toBeCloseTo(20 * Math.cos(30 * kDegree), 4);
    const deep = image(heard(0, [4, 4, 4], north), { azimuth: [90, 90, 90].map((d) => d * kDegree) });
    expect(verticalLine(deep)).toBeNull();
  });

  it('of a turning head each beam counts from where it was heard', () => {
    const made = new SonarImage(sonar({ scanning: true, azimuth: [-0.01, 0, 0.01] }));
    made.take(heard(0, [10], north, [-2, 0, 2]), 1);
    made.take(heard(1, [3], north, [0, 0, 2]), 2);
    const line = verticalLine(made)!;
    expect(line.north).toBe(0);
    const metres = (line.to - line.from) / line.levels.length;
    const strong = [...line.levels.entries()].filter(([, level]) => level === 100);
    const places = strong.map(([cell]) => line.from + (cell + 0.5) * metres);
    expect(places).toEqual([3.5, 8.5].map((m) => expect.closeTo(m, 0)));
    expect(line.from).toBeCloseTo(-2, 2);
  });

  it('leaves echoes of its own kind in the trail', () => {
    const trail = new EchoTrail();
    trail.take(sonar(), heard(0, [3, 3, 3], north), 1);
    trail.take(sonar({ upright: false }), heard(0, [3], [1, 0, 0, 0]), 1);
    expect([...trail.vertical.subarray(0, trail.size)]).toEqual([1, 1, 1, 0]);
  });
});

describe('the beams of a sonar', () => {
  it('have an elevation where the fan stands, an azimuth where it lies', () => {
    const vertical = image(heard(0, [3, 3, 3], north));
    expect([-60, 0, 25].map((d) => directionText(vertical, d * kDegree))).toEqual(['60° up', 'level', '25° down']);
    const flat = image(heard(0, [3, 3, 3], [1, 0, 0, 0]), { upright: false });
    expect([-60, 0].map((d) => directionText(flat, d * kDegree))).toEqual(['−60°', '0°']);
  });

  it('have the elevation that the pitch of the vehicle gives them', () => {
    // pitched up by ten degrees, then rolled by a quarter turn
    const [c, s] = [Math.cos(5 * kDegree) * kRolled, Math.sin(5 * kDegree) * kRolled];
    const made = image(heard(0, [3, 3, 3], [c, c, s, -s]));
    expect(made.elevation(0) / kDegree).toBeCloseTo(10, 4);
    expect(directionText(made, 0)).toBe('10° up');
  });
});
