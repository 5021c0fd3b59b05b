/** SonarView: the samples of a sonar as a fan or unrolled, the detected echoes, and one beam as a curve. */
import { Chart } from '../chart';
import { css, packed, rgbOf, tables, type TableName } from '../colours';
import { byId, context, fit, make, mark, pixelRatio, say } from '../dom';
import { Kind } from '../protocol';
import type { SonarImage } from '../sonar_image';
import * as units from '../units';
import type { Shared, View } from '../view';
import { FanView } from './fan_view';
import type { Form, Sample } from './sample';
import { StripView } from './strip_view';

type FormName = 'fan' | 'strip';

export class SonarView implements View {
  private readonly canvas = byId<HTMLCanvasElement>('sonar-canvas');
  private readonly which = byId<HTMLSelectElement>('sonar-which');
  private readonly colours = byId<HTMLSelectElement>('sonar-colours');
  private readonly slider = byId<HTMLInputElement>('sonar-threshold');
  private readonly sliderText = byId('sonar-threshold-text');
  private readonly decided = byId<HTMLInputElement>('sonar-decided');
  private readonly readout = byId('sonar-readout');
  private readonly none = byId('sonar-none');
  private readonly profile: Chart;
  private readonly forms: Record<FormName, Form> = { fan: new FanView(), strip: new StripView() };
  private readonly buttons = {
    fan: byId<HTMLButtonElement>('sonar-fan'),
    strip: byId<HTMLButtonElement>('sonar-strip'),
  };
  private form: FormName = 'fan';
  private chosen = -1;
  private listed = '';
  private drawn = '';
  private pointer: [number, number] | null = null;
  private held: Sample | null = null;
  private changes = 0;

  constructor(private readonly shared: Shared) {
    this.profile = new Chart(byId('sonar-profile'), shared.theme);
    const touch = () => {
      ++this.changes;
      shared.redraw();
    };
    for (const input of [this.colours, this.slider, this.decided]) input.addEventListener('input', touch);
    this.which.addEventListener('change', () => {
      this.chosen = Number(this.which.value);
      this.held = null;
      touch();
    });
    for (const form of ['fan', 'strip'] as const) {
      this.buttons[form].addEventListener('click', () => {
        this.form = form;
        for (const other of ['fan', 'strip'] as const)
          this.buttons[other].setAttribute('aria-pressed', String(other === form));
        touch();
      });
    }
    const hover = (event: PointerEvent) => {
      const box = this.canvas.getBoundingClientRect();
      this.pointer = [event.clientX - box.left, event.clientY - box.top];
      touch();
    };
    this.canvas.addEventListener('pointermove', hover);
    this.canvas.addEventListener('pointerdown', hover);
    this.canvas.addEventListener('pointerleave', (event) => {
      if (event.pointerType !== 'mouse') return; // keep the beam that a lifted finger pointed at
      this.pointer = null;
      touch();
    });
  }

  frame(): void {
    const { model, theme } = this.shared;
    this.list();
    const image = model.sonars.get(this.chosen);
    this.none.hidden = image !== undefined;
    byId('sonar-scale').hidden = this.which.hidden = !image;
    const resized = fit(this.canvas);
    if (!image) return this.clear();
    if (this.canvas.clientWidth < 20) return;
    const look = `${this.chosen} ${image.revision} ${theme.revision} ${this.changes} ${this.form}`;
    if (look === this.drawn && !resized) return this.tellAge(image);
    this.drawn = look;
    this.draw(image);
    this.tellAge(image);
  }

  /** Without a sonar nothing of an earlier moment stays. */
  private clear(): void {
    if (this.drawn === '') return;
    this.drawn = '';
    this.held = null;
    context(this.canvas).clearRect(0, 0, this.canvas.width, this.canvas.height);
    this.profile.clear();
    for (const id of ['sonar-readout', 'sonar-age', 'sonar-threshold-text']) say(byId(id), '');
    mark(byId('sonar-age'), 'stale', 'false');
    mark(this.canvas, 'sonar', '');
  }

  private list(): void {
    const { model } = this.shared;
    const look = `${model.revision[Kind.sonar]}`;
    if (look === this.listed) return;
    this.listed = look;
    const numbers = [...model.sonars.keys()].sort((a, b) => a - b);
    if (!model.sonars.has(this.chosen)) this.chosen = numbers[0] ?? -1;
    this.which.replaceChildren(
      ...numbers.map((number) => {
        const { sonar } = model.sonars.get(number)!;
        const kind = sonar.scanning ? 'scanning' : sonar.vertical ? 'vertical fan' : 'fan';
        return make(
          'option',
          { value: number, selected: number === this.chosen },
          `${sonar.name || `sonar ${number}`} (${kind})`,
        );
      }),
    );
  }

  private draw(image: SonarImage): void {
    const { paint } = this.shared.theme;
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    const drawing = context(this.canvas);
    const ratio = pixelRatio();
    drawing.setTransform(ratio, 0, 0, ratio, 0, 0);
    drawing.clearRect(0, 0, width, height);
    const threshold = Number(this.slider.value);
    const name = this.colours.value === 'auto' ? paint.intensity : (this.colours.value as TableName);
    const table = passing(tables[name], threshold);
    const mine = this.decided.checked ? packed(paint.decided) : 0;
    this.scale(image, name);
    const look = `${image.revision} ${name} ${threshold} ${mine}`;
    const view = this.forms[this.form];
    view.draw({ drawing, width, height, image, paint, table, decided: mine, look });
    const under = this.pointer && view.sampleAt(...this.pointer, image);
    if (under) this.held = under;
    const shown =
      under ?? (this.held ? { beam: this.held.beam, bin: -1 } : { beam: Math.max(0, image.newest), bin: -1 });
    if (shown.beam < image.beams) {
      view.point(drawing, image, shown, paint.ruler);
      this.curve(image, shown, threshold);
      this.tell(image, shown, threshold);
    }
    say(this.sliderText, threshold === 0 ? 'off' : `${value(image, threshold)}, ${share(image, threshold)} pass`);
    mark(this.canvas, 'sonar', image.sonar.name);
  }

  /** The legend of the levels. */
  private scale(image: SonarImage, name: TableName): void {
    const look = `${name} ${JSON.stringify(image.sonar.scale)}`;
    if (look === this.scaled) return;
    this.scaled = look;
    const [low, bar, high] = byId('sonar-scale').children as unknown as [HTMLElement, HTMLElement, HTMLElement];
    say(low, String(image.sonar.scale.low).replace('-', '−'));
    say(high, `${String(image.sonar.scale.high).replace('-', '−')} ${image.sonar.scale.unit}`.trim());
    const stops = Array.from({ length: 9 }, (_, i) => css(rgbOf(tables[name][Math.min(255, 32 * i)]!)));
    bar.style.background = `linear-gradient(90deg, ${stops.join(',')})`;
  }
  private scaled = '';

  private tell(image: SonarImage, { beam, bin }: Sample, threshold: number): void {
    const azimuth = image.sonar.azimuth[beam]!;
    const aim = image.sonar.vertical
      ? `elevation ${units.elevation(image.elevation(azimuth))}`
      : `azimuth ${units.relativeBearing((azimuth * 180) / Math.PI)}`;
    const parts = [`Beam ${beam}, ${aim}`];
    if (bin >= 0) {
      const i = beam * image.bins + bin;
      const byte = image.intensity[i]!;
      parts.push(`range ${units.metres(image.rangeOf(bin), 2)}`, value(image, byte));
      if (threshold > 0) parts.push(byte >= threshold ? 'passes' : 'below the threshold');
      if (image.decided[i] === 1) parts.push('detected as echo');
      const along = new Float64Array(3);
      image.direction(beam, along);
      const at = (k: number) => image.poses[beam * 7 + k]! + image.rangeOf(bin) * along[k]!;
      parts.push(`N ${units.metres(at(0))}, E ${units.metres(at(1))}, ${units.metres(at(2))} deep`);
    }
    say(this.readout, parts.join(' · '));
  }

  private tellAge(image: SonarImage): void {
    const age = this.shared.model.age(image.time);
    const text = Number.isNaN(age) ? 'no ping yet' : `last ping ${units.age(Math.max(0, age))} old`;
    const element = byId('sonar-age');
    say(element, text);
    mark(element, 'stale', String(age > 2));
  }

  private curve(image: SonarImage, { beam, bin }: Sample, threshold: number): void {
    const { bins } = image;
    const from = beam * bins;
    const x = new Float64Array(bins);
    const y = new Float64Array(bins);
    const decided: (number | null)[] = new Array<number | null>(bins).fill(null);
    const limit: (number | null)[] = new Array<number | null>(bins).fill(
      threshold > 0 ? image.valueOf(threshold) : null,
    );
    const cursor: (number | null)[] = new Array<number | null>(bins).fill(null);
    for (let i = 0; i < bins; ++i) {
      x[i] = image.rangeOf(i);
      y[i] = image.valueOf(image.intensity[from + i]!);
      if (image.decided[from + i] === 1) decided[i] = y[i]!;
    }
    if (bin >= 0) cursor[bin] = y[bin]!;
    const { unit, low, high } = image.sonar.scale;
    this.profile.show(
      [x, y, limit, decided, cursor],
      [
        { label: 'beam', colour: 'plot' },
        { label: 'threshold', colour: 'ruler', dash: [5, 4] },
        { label: 'detected', colour: 'decided', points: true },
        { label: 'cursor', colour: 'ruler', points: true },
      ],
      { x: 'range, m', y: unit ? `level, ${unit}` : 'level', low, high },
    );
  }
}

function value(image: SonarImage, byte: number): string {
  const { unit, low, high } = image.sonar.scale;
  const v = image.valueOf(byte);
  return `${v.toFixed(Math.abs(high - low) < 20 ? 2 : Math.abs(high - low) < 200 ? 1 : 0)} ${unit}`.trim();
}

function share(image: SonarImage, threshold: number): string {
  let pass = 0;
  let all = 0;
  for (let beam = 0; beam < image.beams; ++beam) {
    if (Number.isNaN(image.heard[beam]!)) continue;
    const from = beam * image.bins;
    all += image.bins;
    for (let i = from; i < from + image.bins; ++i) if (image.intensity[i]! >= threshold) ++pass;
  }
  return all > 0 ? `${((100 * pass) / all).toFixed(pass > 0.1 * all ? 0 : 1)} %` : units.percent(NaN);
}

const dimmed = new Map<string, Uint32Array>();
/** The colour table with samples below the threshold dimmed. */
function passing(table: Uint32Array, threshold: number): Uint32Array {
  if (threshold === 0) return table;
  const key = `${table[0]} ${table[255]} ${threshold}`;
  let made = dimmed.get(key);
  if (!made) {
    if (dimmed.size > 64) dimmed.clear();
    made = table.map((word, i) => {
      if (i >= threshold) return word;
      const [r, g, b] = rgbOf(word);
      const grey = Math.round(0.14 * (r + g + b) * 0.6);
      return packed([grey, grey, grey], 255);
    });
    dimmed.set(key, made);
  }
  return made;
}
