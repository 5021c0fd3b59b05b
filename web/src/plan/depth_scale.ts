/** DepthScale: the legend of depths or of confidence beside the layers; rebuilt only if it would look different. */
import { css, rgbOf } from '../colours';
import { make } from '../dom';
import type { Paint } from '../theme';
import type { DepthLayer } from './depth_layer';

const kClasses = ['0–4', '5–9', '10–14', '15–19', '20'];

export class DepthScale {
  private look = '';

  constructor(private readonly box: HTMLElement) {}

  show(paint: Paint, depth: DepthLayer, datum: string, seen: boolean): void {
    const look = `${seen} ${depth.shows} ${depth.deepest} ${datum} ${paint.water}`;
    if (look === this.look) return;
    this.look = look;
    this.box.hidden = !seen;
    this.box.replaceChildren(...(depth.shows === 'depth' ? ramp(paint, depth.deepest, datum) : classes(paint)));
  }
}

function ramp(paint: Paint, deepest: number, datum: string): HTMLElement[] {
  const stops = Array.from({ length: 9 }, (_, i) => css(rgbOf(paint.depth[Math.min(255, i * 32)]!))).join(',');
  const bar = make('div', { class: 'ramp' });
  bar.style.background = `linear-gradient(90deg, ${stops})`;
  const numbers = [0, 0.25, 0.5, 0.75, 1].map((share) => make('span', {}, `${Number((share * deepest).toFixed(2))} m`));
  return [
    make('div', { class: 'ramp-title' }, `Depth${datum ? ` below ${datum}` : ''}`),
    bar,
    make('div', { class: 'ramp-numbers' }, ...numbers),
    make('div', { class: 'ramp-note' }, 'paler: lower confidence; hatched: charted, not measured'),
  ];
}

function classes(paint: Paint): HTMLElement[] {
  const rows = kClasses.map((text, i) => {
    const swatch = make('span', { class: 'class-swatch' });
    swatch.style.background = css(paint.confidence[i]!);
    return make('span', { class: 'class' }, swatch, text);
  });
  return [make('div', { class: 'ramp-title' }, 'Confidence, 0 to 20'), make('div', { class: 'classes' }, ...rows)];
}
