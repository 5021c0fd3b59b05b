import { describe, expect, test } from 'vitest';
import { Model } from '../src/model';
import { Kind } from '../src/protocol';
import { joined, jsonBytes, writeRecord } from '../src/record_writer';
import { SignalHistory, withoutWraps } from '../src/signals';

const names = JSON.stringify([['depth', 'm'], ['depth set-point', 'm'], ['heading', 'deg']]);

function chunk(rows: number[][], columns = names): DataView {
  const text = new TextEncoder().encode(columns);
  const first = 4 + Math.ceil(text.length / 4) * 4;
  const bytes = new Uint8Array(first + 4 * rows.flat().length);
  const view = new DataView(bytes.buffer);
  view.setUint32(0, text.length, true);
  bytes.set(text, 4);
  rows.flat().forEach((value, i) => view.setFloat32(first + 4 * i, value, true));
  return view;
}

describe('signals of a run', () => {
  test('are joined in the order of time, and what is unknown is a gap', () => {
    const history = new SignalHistory();
    expect(history.take(1, chunk([[16, 3, NaN, 10]]))).toBe(true);
    expect(history.take(0, chunk([[0, 1, 2, 359], [1, 1.5, 2, 1]]))).toBe(true);
    expect(history.at).toEqual([0, 1, 16]);
    expect(history.all.map(({ name }) => name)).toEqual(['depth', 'depth set-point', 'heading']);
    expect(history.all[1]!.values).toEqual([2, 2, null]);
  });

  test('a turn through north is no line across the plot', () => {
    expect(withoutWraps({ name: 'heading', unit: 'deg', values: [350, 358, 2, 6] })).toEqual([350, 358, null, 6]);
    expect(withoutWraps({ name: 'depth', unit: 'm', values: [1, 300] })).toEqual([1, 300]);
  });

  test('what is later than the shown moment stays, until another run begins', () => {
    const history = new SignalHistory();
    history.belongTo('a');
    history.take(0, chunk([[0, 1, 2, 3], [1, 1, 2, 3]]));
    history.begin();
    history.take(0, chunk([[0, 1, 2, 3]])); // a jump into the past of the same run
    history.belongTo('a');
    expect(history.at).toEqual([0, 1]);
    history.begin();
    history.take(0, chunk([[0, 9, 2, 3]]));
    history.belongTo('b');
    expect(history.all[0]!.values).toEqual([9]);
    history.begin();
    history.belongTo('c');
    expect(history.at).toEqual([]);
  });

  test('a model that forgets keeps them, and loses none that another run has sent', () => {
    const model = new Model();
    const scene = jsonBytes({ title: 'x', start_ns: '1600000000000000000' });
    const told = (run: string, rows: number[][], forget = false) =>
      model.take(
        joined([
          writeRecord({ kind: Kind.signals, time: 0n, payload: new Uint8Array(chunk(rows).buffer), forget }),
          writeRecord({ kind: Kind.scene, time: 0n, payload: scene }),
          writeRecord({ kind: Kind.clock, time: 0n, payload: jsonBytes({ run, now_s: 0, end_s: 9 }) }),
        ]),
      );
    told('a', [[0, 1, 2, 3], [1, 1, 2, 3]]);
    told('a', [[0, 1, 2, 3]], true);
    expect(model.signals.at).toEqual([0, 1]);
    told('b', [[0, 7, 2, 3]], true);
    expect(model.signals.all[0]!.values).toEqual([7]);
    expect(model.malformed.size).toBe(0);
  });

  test('bytes that do not fit are refused', () => {
    const history = new SignalHistory();
    for (const bad of [new DataView(new ArrayBuffer(2)), chunk([[1, 2]]), chunk([[1]], '[]'), chunk([[1, 2]], '{"a"'), chunk([[1, 2, 3]], '[["a","m"],["a","m"]]')]) {
      expect(history.take(0, bad)).toBe(false);
    }
    const long = new DataView(new ArrayBuffer(64));
    long.setUint32(0, 0xffffffff, true);
    expect(history.take(0, long)).toBe(false);
    expect(history.at).toEqual([]);
  });
});
