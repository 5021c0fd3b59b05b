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
      'ahead', '12° to starboard', '12° to port', '10° to port', 'astern', '170° to port',
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
  });
});

describe('places', () => {
  it('are degrees and minutes to a ten-thousandth', () => {
    expect(units.latitude(52.3375)).toBe('52°20.2500′ N');
    expect(units.latitude(-1.312805)).toBe('01°18.7683′ S');
    expect(units.longitude(-0.99999999)).toBe('001°00.0000′ W');
  });

  // A minute of latitude is a nautical mile, 1852 m, near 45 degrees; at the equator a degree of longitude is a / 57.29578.
  it('are found on the ellipsoid', () => {
    const origin = { latitude: 44.98, longitude: 10 };
    expect(geoPlace(origin, 1852, 0).latitude).toBeCloseTo(44.98 + 1 / 60, 4);
    expect(geoPlace({ latitude: 0, longitude: 0 }, 0, 6378137 * (Math.PI / 180)).longitude).toBeCloseTo(1, 9);
    // Meridian radius at the equator: a (1 - e2).
    expect(geoPlace({ latitude: 0, longitude: 0 }, 6335439.327 * (Math.PI / 180), 0).latitude).toBeCloseTo(1, 8);
  });
});

describe('steps of scales', () => {
  it('are 1, 2 or 5 times a power of ten, next above', () => {
    expect([0.7, 1, 1.1, 2.5, 5, 6, 0.03].map(units.roundStep)).toEqual([1, 1, 2, 5, 5, 10, 0.05]);
  });
});
