/** EchoChoice: which cells of the spherical grid the 3-D view draws, how wide they are, and what the view says of them. */
import { byId, say } from '../dom';
import { keep, keptObject } from '../kept';
import type { Sphere } from '../protocol';
import * as units from '../units';
import { chosen, coarser, farthest, lockedIn, type WhichCells } from './sphere_cells';

const kKey = 'isobath-echo-range';

export class EchoChoice {
  readonly coarser = byId<HTMLSelectElement>('space-coarser');
  readonly which = byId<HTMLSelectElement>('space-which');
  private readonly box = byId('space-range');
  private readonly from = byId<HTMLInputElement>('space-from');
  private readonly to = byId<HTMLInputElement>('space-to');
  private readonly text = byId('space-range-text');
  /** Distances from the vehicle, m; Infinity: to the last layer. */
  private range = { from: 0, to: Infinity };
  private sent: Sphere | null = null;
  private wide: Sphere | null = null;
  private drawn: Sphere | null = null;
  private look = '';

  constructor(changed: () => void) {
    const { from, to } = keptObject(kKey);
    if (typeof from === 'number') this.range.from = from;
    if (typeof to === 'number') this.range.to = to;
    for (const end of [this.from, this.to]) {
      end.addEventListener('input', () => {
        this.moved(end);
        changed();
      });
    }
  }

  /** The cells to draw. The same object as before if nothing has changed. */
  of(sphere: Sphere | null): Sphere | null {
    const look = [this.coarser.value, this.which.value, this.range.from, this.range.to].join();
    if (sphere === this.sent && look === this.look) return this.drawn;
    [this.sent, this.look] = [sphere, look];
    this.wide = sphere && coarser(sphere, Number(this.coarser.value));
    this.showRange();
    const [first, last] = [Number(this.from.value), Number(this.to.value)];
    const which = this.which.value as WhichCells;
    this.drawn = this.wide && { ...this.wide, cells: chosen(this.wide.cells, first, last, which) };
    return this.drawn;
  }

  /** What is drawn, of what there is. */
  words(night: boolean): string[] {
    const { sent, wide, drawn } = this;
    if (!sent || !wide || !drawn) return ['no cells with echoes yet'];
    const merged = wide === sent ? '' : ` (${units.count(sent.cells.length / 4)} merged)`;
    const [of, some] = [wide.cells, drawn.cells].map((cells) => units.count(cells.length / 4));
    const [locked, someLocked] = [wide.cells, drawn.cells].map(lockedIn) as [number, number];
    const brown =
      locked > 0
        ? `${units.count(someLocked)} of ${units.count(locked)} locked ones (${night ? 'amber' : 'brown'})`
        : 'none locked';
    const words = [
      `${some} of ${of} cells with echoes drawn${merged}, ${brown}, ${night ? 'lighter' : 'darker'}: more probable`,
    ];
    const count = sent.cells.length / 4;
    if (count < sent.all) {
      words.push(
        `the page has the nearest ${units.count(count)} of ${units.count(sent.all)} cells, to ${units.metres(farthest(sent))}`,
      );
    }
    return words;
  }

  /** One end pushes the other along. */
  private moved(end: HTMLInputElement): void {
    if (!this.wide) return;
    const { radii } = this.wide;
    const layer = Number(end.value);
    const first = end === this.from ? layer : Math.min(layer, Number(this.from.value));
    const last = end === this.to ? layer : Math.max(layer, Number(this.to.value));
    const to = last === radii.length - 1 ? Infinity : radii[last]!;
    this.range = { from: inner(radii, first), to };
    this.showRange();
    keep(kKey, JSON.stringify(this.range)); // JSON has no Infinity: null
  }

  private showRange(): void {
    const radii = this.wide?.radii ?? new Float32Array([0]);
    const end = radii.length - 1;
    const kEdge = 1e-3; // m
    const layer = (found: number) => (found < 0 ? end : found);
    const first = layer(radii.findIndex((outer) => outer > this.range.from + kEdge));
    const last = Math.max(first, layer(radii.findIndex((outer) => outer > this.range.to - kEdge)));
    for (const [input, value, words] of [
      [this.from, first, metres(inner(radii, first))],
      [this.to, last, metres(radii[last]!)],
    ] as const) {
      input.disabled = this.wide === null;
      input.max = String(end);
      input.value = String(value);
      input.setAttribute('aria-valuetext', words);
    }
    this.box.style.setProperty('--from', String(first / Math.max(1, end)));
    this.box.style.setProperty('--to', String(last / Math.max(1, end)));
    say(this.text, this.wide ? `${metres(inner(radii, first))} to ${metres(radii[last]!)}` : 'no echoes yet');
  }
}

const inner = (radii: Float32Array, layer: number): number => (layer > 0 ? radii[layer - 1]! : 0);
const metres = (value: number): string => units.metres(value, value === 0 ? 0 : value < 10 ? 2 : 1);
