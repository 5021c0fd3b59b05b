/**
 * The speeds of a plan over time, as a small chart: m/s over s since the decision, with a mark at the closest approach.
 * SVG, so that the colours of the page apply.
 */
import { make } from './dom';
import type { Decision } from './items';
import { planned, speeds } from './plan/prediction';
import { age, metres, roundStep, speed as speedText } from './units';

const kWidth = 300;
const kHeight = 92;
const [kLeft, kRight, kTop, kBottom] = [34, 10, 16, 17];

/** "1.50 m/s at first, lowest 0.62 m/s after 6.5 s, 1.50 m/s at the end". */
export function speedWords(way: Decision['way']): string {
  const all = speeds(way);
  const [first, last] = [all[0], all.at(-1)];
  if (!first || !last) return '';
  const least = all.reduce((a, b) => (b.speed < a.speed ? b : a));
  const parts = [`${speedText(first.speed)} at first`, `${speedText(last.speed)} at the end`];
  if (least.speed < Math.min(first.speed, last.speed) - 0.05)
    parts.splice(1, 0, `lowest ${speedText(least.speed)} after ${age(least.at)}`);
  return parts.join(', ');
}

export function speedChart({ way, approach }: Decision): HTMLElement {
  const all = speeds(way);
  const closest = approach && approach.in >= 0 && approach.in <= planned(way) + 1 ? approach.in : undefined;
  const end = Math.max(planned(way), closest ?? 0);
  const most = Math.max(...all.map(({ speed }) => speed));
  const step = roundStep(most / 2.5);
  const top = step * Math.max(1, Math.ceil(most / step - 1e-6));
  const x = (at: number) => kLeft + (at / end) * (kWidth - kLeft - kRight);
  const y = (speed: number) => kHeight - kBottom - (speed / top) * (kHeight - kTop - kBottom);
  const svg = element('svg', { viewBox: `0 0 ${kWidth} ${kHeight}`, width: kWidth, height: kHeight });
  const line = (x1: number, y1: number, x2: number, y2: number, of: string) =>
    svg.append(element('line', { x1, y1, x2, y2, class: of }));
  const text = (at: [number, number], words: string, anchor: string, of = 'speed-text') => {
    const made = element('text', { x: at[0], y: at[1], 'text-anchor': anchor, class: of });
    made.textContent = words;
    svg.append(made);
  };
  for (let speed = 0; speed <= top + 1e-6; speed += step) {
    line(kLeft, y(speed), kWidth - kRight, y(speed), 'speed-grid');
    text([kLeft - 4, y(speed) + 3.5], String(Number(speed.toFixed(2))), 'end');
  }
  text([2, 10], 'm/s', 'start');
  const seconds = roundStep(end / 5);
  for (let at = 0; at <= end + 1e-6; at += seconds) text([x(at), kHeight - 4], at === 0 ? '0 s' : String(at), 'middle');
  svg.append(
    element('polyline', {
      points: all.map(({ at, speed }) => `${x(at).toFixed(1)},${y(speed).toFixed(1)}`).join(' '),
      class: 'speed-line',
    }),
  );
  const parts = [`Planned speed: ${speedWords(way)}`];
  if (approach && closest !== undefined) {
    const at = x(closest);
    line(at, kTop - 2, at, kHeight - kBottom, 'speed-mark');
    const side = at > kWidth / 2 ? 'end' : 'start';
    text([at, 10], `closest: ${metres(Math.max(0, approach.gap))}`, side, 'speed-text speed-closest');
    parts.push(`closest approach after ${age(closest)}`);
  }
  svg.setAttribute('role', 'img');
  svg.setAttribute('aria-label', parts.join('; '));
  return make('div', { class: 'speed-chart' }, svg);
}

function element(tag: string, attributes: Record<string, string | number>): SVGElement {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
  return made;
}
