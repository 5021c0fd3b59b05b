/** Instruments: the main figures of the vehicle. */
import { byId, make, mark, say } from './dom';
import type { Scene } from './items';
import * as units from './units';
import type { Shared, View } from './view';

/** s: an older position is shown as stale. */
const kStale = 2;
/** A battery below this share is marked. */
const kLow = 0.2;

export class Instruments implements View {
  private readonly box = byId('instruments');
  private readonly cells = new Map<string, { value: HTMLElement; wish: HTMLElement; cell: HTMLElement }>();
  private group = '';

  constructor(private readonly shared: Shared) {
    for (const name of ['Heading', 'Speed', 'Depth', 'Altitude', 'Position', 'Route', 'Attitude', 'Battery', 'Leak']) {
      const value = make('span', { class: 'value', id: `now-${name.toLowerCase()}` }, '–');
      const wish = make('span', { class: 'wish' });
      const cell = make('div', { class: 'instrument' }, make('span', { class: 'name' }, name), value, wish);
      this.cells.set(name, { value, wish, cell });
      this.box.append(cell);
    }
  }

  /** Links to the pages of the vehicles that share the mission; the report of one vehicle has none. */
  private vehicles(scene: Scene | null): void {
    const names = scene && document.location.protocol.startsWith('http') ? scene.group : [];
    const look = `${names.join('\n')} ${scene?.own ?? 0}`;
    if (look === this.group) return;
    this.group = look;
    const box = byId('group');
    box.hidden = names.length < 2;
    box.replaceChildren(
      ...names.map((name, i) =>
        make('a', { href: i === 0 ? '/' : `/vehicle/${i + 1}/`, 'aria-current': i === scene?.own && 'page' }, name),
      ),
    );
  }

  frame(): void {
    const { model } = this.shared;
    const { vehicle: v, way, scene } = model;
    say(byId('title'), scene?.title || 'Isobath');
    say(byId('source'), scene ? `${scene.source}${scene.simulated ? ' (simulated)' : ''}` : '');
    this.vehicles(scene);
    this.set('Attitude', units.attitude(v?.roll, v?.pitch), v ? 'roll, pitch' : '');
    this.set('Heading', units.bearing(v?.heading), wish(v && units.bearing(v.wantedHeading), v?.wantedHeading));
    this.set(
      'Speed',
      units.speed(v ? Math.hypot(v.surge, v.sway) : NaN),
      wish(v && units.speed(v.wantedSpeed), v?.wantedSpeed),
    );
    this.set('Depth', units.metres(v?.down), wish(v && units.metres(v.wantedDepth), v?.wantedDepth));
    this.set('Altitude', units.metres(v?.altitude), v ? 'above the bottom' : '');
    this.set('Position', `± ${units.metres(v?.sigma)}`, v ? 'standard deviation' : '');
    const target = way?.target !== undefined ? scene?.mission[way.target]?.name : undefined;
    const phase = way?.phase ?? '';
    const goal = target && `to ${target}`;
    // That a mission holds or is over matters more than its target.
    const [first, second] = goal && (phase === 'under way' || phase === '') ? [goal, phase] : [phase, goal];
    this.set(
      'Route',
      way ? first || 'planned' : '–',
      way ? [way.avoiding ? 'avoiding' : '', second].filter(Boolean).join(', ') : '',
    );
    const age = model.age(model.vehicleTime);
    const old = Number.isFinite(age) && age > kStale;
    mark(this.box, 'stale', String(old));
    say(byId('vehicle-age'), old ? `position is ${units.age(age)} old` : '');
    this.parts();
  }

  /** What the parts of the vehicle report, where they do. */
  private parts(): void {
    const { battery, leak } = this.shared.model.health ?? {};
    this.set('Battery', battery === undefined ? '' : units.percent(battery), battery !== undefined && battery < kLow ? '▲ low' : '');
    this.set('Leak', leak === undefined ? '' : leak ? '▲ WATER' : 'none', '');
    this.cells.get('Battery')!.cell.hidden = battery === undefined;
    this.cells.get('Leak')!.cell.hidden = leak === undefined;
    mark(this.cells.get('Leak')!.cell, 'alarmed', String(leak === true));
    mark(this.cells.get('Battery')!.cell, 'alarmed', String(battery !== undefined && battery < kLow));
  }

  private set(name: string, value: string, wished: string): void {
    const cell = this.cells.get(name)!;
    say(cell.value, value);
    say(cell.wish, wished);
  }
}

function wish(text: string | null, value: number | undefined): string {
  return text !== null && value !== undefined && Number.isFinite(value) ? `set-point ${text}` : '';
}
