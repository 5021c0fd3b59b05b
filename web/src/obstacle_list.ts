/**
 * ObstacleList: the obstacles as people count them, nearest first, each with number, kind, extent, distance and bearing
 * from the vehicle, or as a table. Pointing at one marks it on the chart; a selected one is shown there.
 */
import { arrange, byId, make, say } from './dom';
import { distanceTo, history, nameOf, sizeOf, tracked, type Tracked } from './plan/obstacle_tracks';
import { Kind, type Point } from './protocol';
import { obstacleCells } from './saving';
import * as units from './units';
import type { Shared, View } from './view';

/** Rows shown at a time, which keeps the page small. */
const kRows = 100;

export interface ObstacleRow {
  tracked: Tracked;
  /** m and rad from the vehicle; NaN: it has no position. */
  away: number;
  bearing: number;
}

/** Nearest first; without a vehicle in the order of the last scan. */
export function obstacleRows(all: readonly Tracked[], vehicle: Point | null): ObstacleRow[] {
  const rows = all.map((t): ObstacleRow => {
    if (!vehicle) return { tracked: t, away: NaN, bearing: NaN };
    const { metres, bearing } = distanceTo(t, vehicle);
    return { tracked: t, away: metres, bearing };
  });
  return vehicle ? rows.sort((a, b) => a.away - b.away) : rows;
}

/** "2 obstacles in the last scan, 1 more remembered". */
export function countOf(all: readonly Tracked[]): string {
  const seen = all.filter((t) => t.seen.length > 0).length;
  const more = all.length - seen;
  const scan = `${units.count(seen)} obstacle${seen === 1 ? '' : 's'} in the last scan`;
  return more > 0 ? `${scan}, ${units.count(more)} more remembered` : scan;
}

export class ObstacleList implements View {
  private readonly list = byId('obstacle-list');
  private drawn = '';

  private readonly table = byId('obstacle-table');
  private readonly asTable = byId<HTMLButtonElement>('obstacle-as-table');
  private tabled = '';

  constructor(private readonly shared: Shared) {
    this.asTable.addEventListener('click', () => {
      const on = this.table.hidden;
      this.table.hidden = !on;
      this.list.hidden = on;
      this.asTable.setAttribute('aria-pressed', String(on));
      this.tabled = this.drawn = '';
      shared.redraw();
    });
  }

  frame(): void {
    const { model, obstacle, hovered } = this.shared;
    const all = tracked(model);
    say(byId('obstacle-count'), all.length > 0 ? ` ${units.count(all.length)}` : '');
    if (!this.table.hidden) return this.fillTable();
    if (this.list.clientWidth === 0) return;
    say(byId('obstacle-sum'), all.length > 0 ? countOf(all) : 'No obstacles.');
    const { vehicle } = model;
    const rows = obstacleRows(all, vehicle && [vehicle.north, vehicle.east]);
    const look = `${model.revision[Kind.obstacles]} ${model.revision[Kind.vehicle]} ${obstacle} ${hovered}`;
    if (look === this.drawn) return;
    const arranged = arrange(this.list, rows.slice(0, kRows).map((row, place) => this.row(row, place)));
    if (arranged) this.drawn = look;
  }

  private fillTable(): void {
    const { model } = this.shared;
    const look = `${model.revision[Kind.obstacles]}`;
    if (this.table.clientWidth === 0 || look === this.tabled) return;
    this.tabled = look;
    say(byId('obstacle-sum'), countOf(tracked(model)));
    const [names = [], ...rows] = obstacleCells(model);
    const cells = (tag: 'th' | 'td', texts: readonly string[], scope?: string) =>
      make('tr', {}, ...texts.map((text) => make(tag, { scope }, text.replaceAll('_', ' '))));
    this.table.querySelector('thead')!.replaceChildren(cells('th', names, 'col'));
    this.table.querySelector('tbody')!.replaceChildren(...rows.map((row) => cells('td', row)));
  }

  /** The row of one obstacle, which keeps its element for as long as it is listed: a press on it ends on it. */
  private row({ tracked: t, away, bearing }: ObstacleRow, place: number): HTMLElement {
    const { model, obstacle, hovered } = this.shared;
    const item = this.element(t.number ?? `no number, place ${place}`, t.number);
    const part = (name: string) => item.querySelector<HTMLElement>(name)!;
    say(part('strong'), sizeOf(t) || nameOf(t));
    say(part('.obstacle-away'), `${units.metres(away)}, ${units.bearing(bearing)}`);
    say(part('.log-reason'), history(t, model.now).join(', '));
    const chosen = t.number !== undefined && t.number === obstacle;
    part('button').setAttribute('aria-pressed', String(chosen));
    item.classList.toggle('chosen', chosen || (t.number !== undefined && t.number === hovered));
    return item;
  }

  private element(key: number | string, number: number | undefined): HTMLElement {
    const before = this.list.querySelector<HTMLElement>(`[data-row="${key}"]`);
    if (before) return before;
    const head = make(
      'span',
      { class: 'log-head' },
      make('span', { class: 'log-number' }, number === undefined ? '?' : String(number)),
      make('strong'),
      make('span', { class: 'obstacle-away' }),
    );
    const button = make('button', { type: 'button', class: 'log-row' }, head, make('span', { class: 'log-reason' }));
    if (number !== undefined) {
      button.addEventListener('click', () => this.shared.showObstacle(number));
      button.addEventListener('pointerenter', () => this.shared.hover(number));
      button.addEventListener('pointerleave', () => this.shared.hover(null));
    }
    return make('li', { 'data-row': key, 'data-obstacle': number }, button);
  }
}
