/**
 * EchoTrail: positions of recently detected echoes in W, in a ring buffer that overwrites the oldest. A run of
 * neighbouring bins of a beam is one position, at its nearest bin, where the object begins.
 *
 * Echoes of a fan are kept for 3 s, those of a scanning head for 40 s, which is a little more than a turn.
 */
import type { Sonar } from './items';
import type { Echoes } from './protocol';
import { turn } from './sonar_image';

const kFanLasts = 3;
const kScanLasts = 40;

export class EchoTrail {
  static readonly capacity = 1 << 14;
  /** Three numbers a position: north, east, down. */
  readonly places = new Float32Array(3 * EchoTrail.capacity);
  /** s since 1970 */
  readonly times = new Float64Array(EchoTrail.capacity);
  readonly lasts = new Float32Array(EchoTrail.capacity);
  /** 1: echo of a vertical fan, whose horizontal offset from the line of the fan is unknown. */
  readonly vertical = new Uint8Array(EchoTrail.capacity);
  /** Number of positions held, and the index of the next one. */
  size = 0;
  next = 0;
  private readonly along = new Float64Array(3);

  clear(): void {
    this.size = this.next = 0;
  }

  take(sonar: Sonar, echoes: Echoes, time: number): void {
    const { bins, decided, first, rotation, place } = echoes;
    const lasts = sonar.scanning ? kScanLasts : kFanLasts;
    const vertical = sonar.vertical ? 1 : 0;
    for (let beam = 0; beam < echoes.beams; ++beam) {
      const azimuth = sonar.azimuth[first + beam] ?? 0;
      turn(rotation[0], rotation[1], rotation[2], rotation[3], Math.cos(azimuth), Math.sin(azimuth), this.along);
      let before = false;
      for (let bin = 0; bin < bins; ++bin) {
        const i = beam * bins + bin;
        const here = ((decided[i >> 3]! >> (i & 7)) & 1) === 1;
        if (here && !before) this.put(place, sonar.first + (bin + 0.5) * sonar.bin, time, lasts, vertical);
        before = here;
      }
    }
  }

  private put(
    from: readonly [number, number, number],
    range: number,
    time: number,
    lasts: number,
    vertical: 0 | 1,
  ): void {
    const at = this.next;
    for (let k = 0; k < 3; ++k) this.places[3 * at + k] = from[k]! + range * this.along[k]!;
    this.times[at] = time;
    this.lasts[at] = lasts;
    this.vertical[at] = vertical;
    this.next = (at + 1) % EchoTrail.capacity;
    this.size = Math.min(this.size + 1, EchoTrail.capacity);
  }
}
