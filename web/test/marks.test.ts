import { expect, test } from 'vitest';
import { Marks } from '../src/marks';
import { Model } from '../src/model';
import { Kind } from '../src/protocol';
import { jsonBytes, writeRecord } from '../src/record_writer';

const second = 1_000_000_000n;
function told(model: Model, run: string, decisions: string[]): void {
  model.take(writeRecord({ kind: Kind.scene, time: 0n, forget: true, payload: jsonBytes({ title: 's', start_ns: '0' }) }));
  model.take(writeRecord({ kind: Kind.clock, time: 0n, payload: jsonBytes({ now_s: 9, run }) }));
  decisions.forEach((what, i) =>
    model.take(writeRecord({ kind: Kind.decision, number: BigInt(i + 1), time: BigInt(i) * second, payload: jsonBytes({ agent: 'a', what }) })),
  );
}

test('marks outlast a jump in time, and end with their run, though simulated runs start at the same time', () => {
  const model = new Model();
  const marks = new Marks(model);
  told(model, 'one', ['plan', 'replan']);
  marks.update();
  told(model, 'one', ['plan']);
  marks.update();
  expect(marks.all.size).toBe(2);
  told(model, 'two', ['hold']);
  marks.update();
  expect([...marks.all.values()].map(({ what }) => what)).toEqual(['1. a: hold']);
});
