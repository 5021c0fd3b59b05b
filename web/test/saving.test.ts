import { expect, test } from 'vitest';
import { Model } from '../src/model';
import { Kind } from '../src/protocol';
import { jsonBytes, writeRecord } from '../src/record_writer';
import { geoJson, obstacleTable, placeOf, trackTable } from '../src/saving';

function model(origin?: object): Model {
  const made = new Model();
  made.take(writeRecord({ kind: Kind.scene, time: 0n, payload: jsonBytes({ start_ns: '0', origin, mission: [{ name: 'A, B', at: [100, 0] }] }) }));
  const places = new Float32Array([0, 1, 2, 3, 1, 4, 5, 6]);
  made.take(writeRecord({ kind: Kind.track, time: 0n, payload: new Uint8Array(places.buffer) }));
  const obstacles = [{ number: 7, kind: 'compact', extent_m: 1.5, existence: 0.9, in_scan: true, since_s: 2, seen_s: 3 }];
  const pieces = [{ number: 7, outline: [[10, 20], [12, 20], [12, 22], [10, 22]], existence: 0.9 }];
  made.take(writeRecord({ kind: Kind.obstacles, time: 0n, payload: jsonBytes({ obstacles, pieces }) }));
  return made;
}

test('track and obstacles as tables, with latitude and longitude where the run has an origin', () => {
  expect(trackTable(model())).toBe('time_s,north_m,east_m,depth_m\n0.00,1.000,2.000,3.000\n1.00,4.000,5.000,6.000\n');
  expect(trackTable(model({ latitude: 0, longitude: 0 })).split('\n')[2]).toMatch(/^1.00,4.000,5.000,6.000,0.00003\d+,0.00004\d+$/);
  expect(obstacleTable(model()).split('\n')[1]).toBe('7,compact,1.50,0.900,true,2.0,3.0,11.00,21.00');
});

test('GeoJSON is in degrees, longitude first, and needs an origin', () => {
  expect(geoJson(model())).toBeNull();
  const { features } = JSON.parse(geoJson(model({ latitude: 0, longitude: 0 }))!) as { features: { geometry: { type: string; coordinates: unknown }; properties: { what: string; name?: string } }[] };
  expect(features.map(({ properties }) => properties.what)).toEqual(['obstacle', 'mission point']);
  const [east, north] = features[1]!.geometry.coordinates as [number, number];
  expect(east).toBeCloseTo(0, 9);
  expect(north * 110_574).toBeCloseTo(100, 0); // a degree of latitude at the equator, WGS 84
});

test('a link names a moment and a section; what it does not name is left as it is', () => {
  expect(placeOf('#t=61.5&n=1&e=-2&s=0.25')).toEqual({ t: 61.5, n: 1, e: -2, s: 0.25 });
  expect(placeOf('#t=x')).toEqual({ t: undefined, n: undefined, e: undefined, s: undefined });
});
