/**
 * PlotsView: chosen signals over the time of the run, one below the other on one time axis, a set-point with its signal.
 * A line marks the shown moment; a press on a plot goes to its moment.
 */
import { Chart, type Curve } from './chart';
import { byId, make, say } from './dom';
import { keep, keptObject } from './kept';
import { withoutWraps, type Signal } from './signals';
import type { Shared, View } from './view';

const kKey = 'isobath-plots';
const kSetpoint = ' set-point';
/** What a page shows that has never chosen. */
const kFirst = ['speed', 'depth', 'nearest obstacle'];
/** ms between two drawings while the run goes on. */
const kInterval = 250;

/** A signal with the set-point that belongs to it. */
interface Plot {
  box: HTMLElement;
  words: HTMLElement;
  chart: Chart;
}

export class PlotsView implements View {
  private readonly body = byId('plots-body');
  private readonly list = byId('plots-choice');
  private readonly summary = byId('plots-chosen');
  private readonly chosen = new Set<string>();
  private readonly plots = new Map<string, Plot>();
  private listed = '';
  private drawn = '';
  private last = -Infinity;

  constructor(
    private readonly shared: Shared,
    private readonly seek: (to: number) => void,
  ) {
    const { names } = keptObject(kKey);
    for (const name of Array.isArray(names) ? names : kFirst) if (typeof name === 'string') this.chosen.add(name);
  }

  frame(now: number): void {
    if (this.body.clientWidth === 0) return;
    const { model, theme } = this.shared;
    const { signals, clock } = model;
    const look = `${signals.revision} ${model.now} ${theme.revision} ${this.body.clientWidth} ${[...this.chosen].join()}`;
    if (look === this.drawn) return;
    if (now - this.last < kInterval) return this.shared.redraw();
    [this.drawn, this.last] = [look, now];
    const all = signals.all;
    byId('plots-none').hidden = all.length > 0;
    this.choose(all);
    const names = all.map(({ name }) => name).filter((name) => this.chosen.has(name));
    say(this.summary, names.length > 0 ? `Signals: ${names.join(', ')}` : 'Signals');
    const end = Math.max(clock?.end ?? 0, clock?.present ?? 0, signals.at.at(-1) ?? 0);
    for (const { name, unit } of all) {
      if (name.endsWith(kSetpoint)) continue;
      if (this.chosen.has(name)) this.draw(name, unit, all, end);
      else this.drop(name);
    }
  }

  private choose(all: readonly Signal[]): void {
    const names = all.map(({ name }) => name).filter((name) => !name.endsWith(kSetpoint));
    if (names.join() === this.listed) return;
    this.listed = names.join();
    this.list.replaceChildren(
      ...names.map((name) => {
        const box = make('input', { type: 'checkbox', checked: this.chosen.has(name) });
        box.addEventListener('change', () => {
          if (box.checked) this.chosen.add(name);
          else this.chosen.delete(name);
          keep(kKey, JSON.stringify({ names: [...this.chosen] }));
          this.last = -Infinity;
          this.shared.redraw();
        });
        return make('label', { class: 'check' }, box, ` ${name}`);
      }),
    );
  }

  private draw(name: string, unit: string, all: readonly Signal[], end: number): void {
    const { model } = this.shared;
    const signals = all.filter((signal) => signal.name === name || signal.name === name + kSetpoint);
    const plot = this.plots.get(name) ?? this.make(name);
    if (!this.plots.has(name)) {
      this.plots.set(name, plot);
      const order = all.map((signal) => signal.name);
      const after = [...this.plots].filter(([other]) => order.indexOf(other) > order.indexOf(name)).map(([, { box }]) => box);
      this.body.insertBefore(plot.box, after.find((box) => box.parentElement === this.body) ?? null);
    }
    const at = indexOf(model.signals.at, model.now);
    const shown = unit === 'deg' ? '°' : unit;
    const told = signals.map(({ name: own, values }) => {
      const value = at < 0 ? null : values[at];
      const number = value === null || value === undefined ? '–' : value.toFixed(Math.abs(value) < 10 ? 2 : 1);
      return `${own} ${number}${shown === '°' ? '' : ' '}${shown}`;
    });
    say(plot.words, told.join(', '));
    const curves: Curve[] = signals.map((_, i) => (i === 0 ? { label: name, colour: 'plot' } : { label: 'set-point', colour: 'decided', dash: [5, 4] }));
    const values = signals.map((signal) => withoutWraps(signal));
    const axes = { x: '', y: shown, end, now: model.now, down: name === 'depth' };
    plot.chart.show([[...model.signals.at], ...values], curves, axes);
    plot.box.dataset.samples = String(values[0]?.filter((value) => value !== null).length ?? 0);
  }

  private make(name: string): Plot {
    const words = make('figcaption');
    const area = make('div', { class: 'signal-plot' });
    const box = make('figure', { class: 'signal', 'data-signal': name }, words, area);
    return { box, words, chart: new Chart(area, this.shared.theme, this.seek) };
  }

  private drop(name: string): void {
    const plot = this.plots.get(name);
    plot?.chart.clear();
    plot?.box.remove();
    this.plots.delete(name);
  }
}

/** Index of the last sample at or before a time; -1: there is none. */
function indexOf(times: readonly number[], time: number): number {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle]! <= time + 1e-6) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}
