/**
 * SignalHistory: what the vehicle measured and what it was told to do, a sample a second, over the whole run. It
 * outlasts what the model forgets, as at each jump in time, so that a plot also shows what is later than the shown
 * moment. Another run ends it.
 */
import { list, words } from './json';

/** A curve of a plot; NaN in `values` becomes null: a gap. */
export interface Signal {
  name: string;
  unit: string;
  values: (number | null)[];
}

interface Chunk {
  names: string;
  columns: { name: string; unit: string }[];
  /** Row after row: seconds since the start, then a value for each column. */
  rows: Float32Array;
  /** In which life of the model it came. */
  life: number;
}

const [kMostColumns, kMostNames, kMostChunks, kMostRows] = [64, 8192, 100_000, 4096];
/** Half a turn, degrees: a greater step of a heading is its way through north, and no curve. */
const kHalf = 180;

export class SignalHistory {
  revision = 0;
  private readonly chunks = new Map<number, Chunk>();
  private life = 0;
  private run = '';
  private built = -1;
  private readonly times: number[] = [];
  private readonly signals = new Map<string, Signal>();

  /** False: not understood. */
  take(index: number, payload: DataView): boolean {
    const chunk = readChunk(payload, this.life);
    if (!chunk || index >= kMostChunks) return false;
    const known = this.chunks.get(index);
    // In the past of the same run the program tells less than is known.
    if (known && known.names === chunk.names && begins(known.rows, chunk.rows)) {
      known.life = this.life;
      return true;
    }
    this.chunks.set(index, chunk);
    ++this.revision;
    return true;
  }

  /** The model forgets all: what comes now may be of another run. */
  begin(): void {
    ++this.life;
  }

  /** Names the run that is shown: of another one only what has come since `begin` stays. */
  belongTo(run: string): void {
    if (run === this.run) return;
    this.run = run;
    for (const [index, { life }] of this.chunks) if (life < this.life) this.chunks.delete(index);
    ++this.revision;
  }

  /** Times of the samples, s since the start. */
  get at(): readonly number[] {
    this.build();
    return this.times;
  }
  /** In the order of the newest chunk. */
  get all(): readonly Signal[] {
    this.build();
    return [...this.signals.values()];
  }

  private build(): void {
    if (this.built === this.revision) return;
    this.built = this.revision;
    this.times.length = 0;
    this.signals.clear();
    const chunks = [...this.chunks].sort(([a], [b]) => a - b).map(([, chunk]) => chunk);
    for (const { name, unit } of chunks.at(-1)?.columns ?? []) this.signals.set(name, { name, unit, values: [] });
    for (const { columns, rows } of chunks) {
      const width = columns.length + 1;
      for (let i = 0; i < rows.length; i += width) {
        if (rows[i]! <= (this.times.at(-1) ?? -Infinity)) continue;
        this.times.push(rows[i]!);
        columns.forEach(({ name }, k) => {
          const value = rows[i + 1 + k]!;
          this.signals.get(name)?.values.push(Number.isFinite(value) ? value : null);
        });
        for (const { values } of this.signals.values()) if (values.length < this.times.length) values.push(null);
      }
    }
  }
}

/** Whether `all` is longer and begins with `part`. */
function begins(all: Float32Array, part: Float32Array): boolean {
  return all.length > part.length && part.every((value, i) => Object.is(value, all[i]));
}

/** A heading without the lines that lead from 359 to 0 degrees. */
export function withoutWraps({ unit, values }: Signal): (number | null)[] {
  if (unit !== 'deg') return values;
  return values.map((value, i) => {
    const last = values[i - 1];
    return value !== null && last !== null && last !== undefined && Math.abs(value - last) > kHalf ? null : value;
  });
}

function readChunk(payload: DataView, life: number): Chunk | null {
  if (payload.byteLength < 4) return null;
  const size = payload.getUint32(0, true);
  const first = 4 + Math.ceil(size / 4) * 4;
  if (size > kMostNames || first > payload.byteLength) return null;
  let columns: Chunk['columns'];
  const names = new TextDecoder().decode(new Uint8Array(payload.buffer, payload.byteOffset + 4, size));
  try {
    columns = list(JSON.parse(names)).map((pair) => ({ name: words(list(pair)[0]), unit: words(list(pair)[1]) }));
  } catch {
    return null;
  }
  const width = columns.length + 1;
  const floats = (payload.byteLength - first) / 4;
  const known = new Set(columns.map(({ name }) => name));
  if (columns.length === 0 || columns.length > kMostColumns || known.size < columns.length) return null;
  if (floats % width !== 0 || floats / width > kMostRows) return null;
  const rows = Float32Array.from({ length: floats }, (_, i) => payload.getFloat32(first + 4 * i, true));
  return { names, columns, rows, life };
}
