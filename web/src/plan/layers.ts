/** Layers: the list of layers with their switches; it is also the legend. */
import { css } from '../colours';
import { make } from '../dom';
import { keep, keptObject } from '../kept';
import type { Paint } from '../theme';

export const layerNames = {
  depth: 'Depth map',
  grid: 'Occupancy grid: free, occupied',
  samples: 'Sonar samples',
  echoes: 'Detected echoes',
  land: 'Land',
  fence: 'Fence and keep-out areas',
  bodies: 'Ground truth',
  obstacles: 'Obstacles: existence, range; dotted: remembered; line: earlier positions; arrow: way of 10 s',
  predicted: 'Predicted motion within 40 m: 2σ of the place; outline in 5, 10, 15, 20 s',
  sounds: 'Sounds: direction, frequency, obstacle',
  mission: 'Mission points and legs',
  oldWays: 'Earlier routes',
  way: 'Route',
  track: 'Track',
  vehicle: 'Vehicle, course of 10 s, 2σ',
  partners: 'Vehicles of the group, as last heard',
} as const;
export type LayerName = keyof typeof layerNames;

/** What a skipper steers by. While one of them has content and is hidden, the chart says so. */
const kSafety: Partial<Record<LayerName, string>> = {
  obstacles: 'obstacles',
  fence: 'fence',
  land: 'land',
  depth: 'depths',
  way: 'route',
  vehicle: 'vehicle',
  partners: 'other vehicles',
};

const kKey = 'isobath-layers';

export class Layers {
  readonly on = new Map<LayerName, boolean>();
  private readonly rows = new Map<LayerName, HTMLElement>();
  private readonly inputs = new Map<LayerName, HTMLInputElement>();

  constructor(
    private readonly box: HTMLElement,
    changed: () => void,
  ) {
    const kept = keptObject(kKey);
    for (const name of Object.keys(layerNames) as LayerName[]) {
      const on = kept[name];
      this.on.set(name, typeof on === 'boolean' ? on : name !== 'samples');
      const input = make('input', {
        type: 'checkbox',
        id: `layer-${name}`,
        'data-layer': name,
        checked: this.on.get(name),
      });
      input.addEventListener('change', () => {
        this.on.set(name, input.checked);
        keep(kKey, JSON.stringify(Object.fromEntries(this.on)));
        changed();
      });
      this.inputs.set(name, input);
      const swatch = make('span', { class: 'swatch', 'aria-hidden': 'true' });
      const row = make('label', { class: 'layer' }, input, swatch, make('span', {}, layerNames[name]));
      this.rows.set(name, row);
      box.append(row);
    }
  }

  shows(name: LayerName): boolean {
    return this.on.get(name) === true;
  }

  toggle(name: LayerName): void {
    this.inputs.get(name)?.click();
  }

  /** The layers of kSafety that have content and are hidden. */
  get hiddenSafety(): string[] {
    return this.safety().map(([, words]) => words);
  }
  showSafety(): void {
    for (const [name] of this.safety()) this.toggle(name);
  }
  private safety(): [LayerName, string][] {
    const all = Object.entries(kSafety) as [LayerName, string][];
    return all.filter(([name]) => !this.shows(name) && this.rows.get(name)?.hidden === false);
  }

  paint(paint: Paint): void {
    for (const [name, row] of this.rows) row.querySelector('.swatch')!.replaceChildren(swatch(name, paint));
  }

  /** Hides the switch of a layer that has no content. */
  offer(name: LayerName, there: boolean): void {
    const row = this.rows.get(name);
    if (row && row.hidden === there) row.hidden = !there;
  }

  get element(): HTMLElement {
    return this.box;
  }
}

/** A sample in the same colours and dashes as on the map. */
function swatch(name: LayerName, p: Paint): SVGElement {
  const svg = element('svg', { width: 28, height: 16, viewBox: '0 0 28 16' });
  const line = (stroke: string, width: number, dash = '') =>
    svg.append(
      element('line', { x1: 1, y1: 8, x2: 27, y2: 8, stroke, 'stroke-width': width, 'stroke-dasharray': dash }),
    );
  const box = (fill: string, stroke = 'none', dash = '') =>
    svg.append(
      element('rect', {
        x: 2,
        y: 2,
        width: 24,
        height: 12,
        fill,
        stroke,
        'stroke-width': 1.5,
        'stroke-dasharray': dash,
      }),
    );
  switch (name) {
    case 'depth':
      for (let i = 0; i < 6; ++i)
        svg.append(
          element('rect', {
            x: 2 + 4 * i,
            y: 2,
            width: 4.2,
            height: 12,
            fill: css([p.depth[i * 50]! & 255, (p.depth[i * 50]! >> 8) & 255, (p.depth[i * 50]! >> 16) & 255]),
          }),
        );
      break;
    case 'grid':
      box(css(p.free, 0.6), p.faint);
      svg.append(element('rect', { x: 14, y: 2, width: 12, height: 12, fill: css(p.occupied, 0.85) }));
      break;
    case 'samples':
      svg.append(element('path', { d: 'M14 15 L3 4 A15 15 0 0 1 25 4 Z', fill: css(p.echo, 0.45), stroke: p.faint }));
      break;
    case 'echoes':
      for (const [x, y] of [
        [5, 10],
        [10, 7],
        [15, 6],
        [20, 8],
        [24, 11],
      ] as const)
        svg.append(element('rect', { x, y, width: 3, height: 3, fill: css(p.echo) }));
      break;
    case 'land':
      box(p.land, p.shore);
      break;
    case 'fence':
      line(p.fence, 2, '6 4');
      break;
    case 'bodies':
      svg.append(
        element('circle', {
          cx: 14,
          cy: 8,
          r: 6,
          fill: 'none',
          stroke: p.truth,
          'stroke-width': 1.5,
          'stroke-dasharray': '3 3',
        }),
      );
      break;
    case 'obstacles':
      box(p.obstacleFill, p.obstacle);
      break;
    case 'predicted':
      for (const [cx, opacity] of [
        [22, 0.35],
        [15, 0.65],
        [8, 1],
      ] as const)
        svg.append(element('circle', { cx, cy: 8, r: 5.5, fill: p.obstacleFill, stroke: p.obstacle, opacity }));
      break;
    case 'sounds':
      line(p.sound, 2, '8 5');
      break;
    case 'mission':
      svg.append(element('circle', { cx: 14, cy: 8, r: 6, fill: 'none', stroke: p.mission, 'stroke-width': 2.2 }));
      break;
    case 'oldWays':
      line(p.way, 1.5, '6 4');
      svg.setAttribute('opacity', '0.5');
      break;
    case 'way':
      line(p.way, 2.5);
      break;
    case 'track':
      line(p.track, 2.2);
      break;
    case 'partners':
      svg.append(element('path', { d: 'M14 2 L20 8 L14 14 L8 8 Z', fill: p.halo, stroke: p.vehicle, 'stroke-width': 2 }));
      break;
    case 'vehicle':
      svg.append(element('path', { d: 'M24 8 L6 2 L10 8 L6 14 Z', fill: p.vehicle, stroke: p.vehicleEdge }));
      break;
  }
  return svg;
}

function element(tag: string, attributes: Record<string, string | number>): SVGElement {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
  return made;
}
