import { zlibSync } from 'fflate';
import { expect, test } from 'vitest';
import { Model } from '../src/model';
import { Kind } from '../src/protocol';
import { joined, jsonBytes, writeRecord } from '../src/record_writer';

const packed = (records: Uint8Array): Uint8Array => zlibSync(records);
function slice(channel: number, all: Uint8Array, from: number, to: number): Uint8Array {
  const payload = new Uint8Array(8 + to - from);
  const view = new DataView(payload.buffer);
  view.setUint32(0, from, true);
  view.setUint32(4, all.length, true);
  payload.set(all.subarray(from, to), 8);
  return writeRecord({ kind: Kind.packed, number: BigInt(channel), time: 0n, payload });
}
const way = (why: string): Uint8Array => writeRecord({ kind: Kind.way, time: 0n, payload: jsonBytes({ points: [], why }) });
const clock = (now_s: number): Uint8Array => writeRecord({ kind: Kind.clock, time: 0n, payload: jsonBytes({ now_s }) });

test('packed records come in slices, and urgent ones between them', () => {
  const model = new Model();
  const bulky = packed(way('bulky'));
  model.take(slice(1, bulky, 0, 10));
  expect(model.way).toBeNull();
  const urgent = packed(clock(7));
  model.take(joined([slice(0, urgent, 0, urgent.length), slice(1, bulky, 10, bulky.length)]));
  expect(model.now).toBe(7);
  expect(model.way?.why).toBe('bulky');
  expect([...model.malformed]).toEqual([]);
});

test('a new set replaces one that did not end; what does not fit is counted and changes nothing', () => {
  const model = new Model();
  const [first, second] = [packed(way('first')), packed(way('second'))];
  model.take(slice(1, first, 0, 10));
  model.take(slice(1, second, 0, second.length));
  expect(model.way?.why).toBe('second');
  model.take(slice(1, first, 10, first.length));
  model.take(slice(2, first, 0, first.length));
  const broken = first.slice().fill(255, 2);
  model.take(slice(0, broken, 0, broken.length));
  model.take(writeRecord({ kind: Kind.packed, time: 0n, payload: new Uint8Array(4) }));
  expect(model.malformed.get('packed records')).toBe(4);
  expect(model.way?.why).toBe('second');
});
