import { describe, expect, it } from 'vitest';
import { geoPlace } from '../src/geo';
import * as units from '../src/units';

describe('numbers', () => {
  it('have their unit and a true minus', () => {
    expect(units.metres(-3.14159)).toBe('−3.1 m');
    expect(units.metres(-0.01)).toBe('0.0 m');
    expect(units.metres(12345)).toBe('12.3 km');
    expect(units.speed(1.1)).toBe('1.10 m/s');
    expect(units.percent(0.856)).toBe('86 %');
    expect(units.milliseconds(0.5)).toBe('0.50 ms');
    expect(units.rate(1234567)).toBe('1.2 MB/s');
  });

  it('that are not known are said to be so', () => {
    for (const text of [units.metres(NaN), units.metres(undefined), units.metres(null)]) expect(text).toBe('– m');
    expect(units.bearing(NaN)).toBe('–°');
    expect(units.elapsed(NaN)).toBe('–');
    expect(units.utc(NaN)).toBe('–');
  });
});

describe('bearings', () => {
  it('have three figures from 000 to 359', () => {
    const degrees = (d: number) => units.bearing((d * Math.PI) / 180);
    expect([0, 47, 359.4, 359.6, -1, 720].map(degrees)).toEqual(['000°', '047°', '359°', '000°', '359°', '000°']);
  });
  it('from the bow say the side', () => {
    expect([0, 12, -12, 350, 180, 190].map(units.relativeBearing)).toEqual([
      'ahead',
      '12° to starboard',
      '12° to port',
      '10° to port',
      'astern',
      '170° to port',
    ]);
  });
});

describe('times', () => {
  it('carry over', () => {
    expect(units.elapsed(59.96)).toBe('1:00.0');
    expect(units.elapsed(3599.99)).toBe('1:00:00.0');
    expect(units.elapsed(62.4, 0)).toBe('1:02');
    expect(units.elapsed(-2)).toBe('−0:02.0');
    expect(units.utc(1_777_629_604)).toBe('2026-05-01 10:00:04 UTC');
    expect(units.utc(114.6), 'a simulation has no date').toBe('');
  });
});

describe('places', () => {
  it('are degrees and minutes to a ten-thousandth', () => {
    expect(units.latitude(52.3375)).toBe('52°20.2500′ N');
    expect(units.latitude(-1.312805)).toBe('01°18.7683′ S');
    expect(units.longitude(-0.99999999)).toBe('001°00.0000′ W');
  });

  // Origin, north and east, and what GeographicLib's LocalCartesian has for the point at height 0 there.
  it('are those of GeographicLib to a millimetre', () => {
    const worked: [[number, number], [number, number], [number, number]][] = [
      [
        [52.3375, 12.993],
        [5000, 8000],
        [52.382375705, 13.110489351],
      ],
      [
        [52.3375, 12.993],
        [-12000, 300],
        [52.229656725, 12.997390714],
      ],
      [
        [52.3375, 12.993],
        [40, -25],
        [52.337859473, 12.992633215],
      ],
      [
        [1.3128, 103.742],
        [5000, 8000],
        [1.358017192, 103.813885297],
      ],
      [
        [1.3128, 103.742],
        [-12000, 300],
        [1.204276122, 103.744695537],
      ],
      [
        [1.3128, 103.742],
        [40, -25],
        [1.313161746, 103.741775363],
      ],
      [
        [-63.5, -179.99],
        [5000, 8000],
        [-63.455054664, -179.829622732],
      ],
      [
        [-63.5, -179.99],
        [-12000, 300],
        [-63.607651837, -179.983953647],
      ],
      [
        [-63.5, -179.99],
        [40, -25],
        [-63.499641157, -179.990501959],
      ],
    ];
    for (const [[latitude, longitude], [north, east], must] of worked) {
      const is = geoPlace({ latitude, longitude }, north, east);
      expect(is.latitude).toBeCloseTo(must[0], 8);
      expect(is.longitude).toBeCloseTo(must[1], 8);
    }
  });
});

describe('steps of scales', () => {
  it('are 1, 2 or 5 times a power of ten, next above', () => {
    expect([0.7, 1, 1.1, 2.5, 5, 6, 0.03].map(units.roundStep)).toEqual([1, 1, 2, 5, 5, 10, 0.05]);
  });
});

describe('the lines around the vehicle', () => {
  // ledger: S4-39
  it('say round distances, and bearings from the bow in short', () => {
    expect([0.5, 20, 500, 1000, 2000].map(units.roundMetres)).toEqual(['0.5 m', '20 m', '500 m', '1 km', '2 km']);
    expect([0, 30, 180, 330].map(units.fromBow)).toEqual(['ahead', '30° stb', 'astern', '30° port']);
  });
});
