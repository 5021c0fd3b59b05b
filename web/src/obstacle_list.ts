/**
 * ObstacleList: the obstacles as people count them, nearest first, each with number, kind, extent, distance and bearing
 * from the vehicle. Pointing at one marks it on the chart; a selected one is shown there.
 */
import { arrange, byId, make, say } from './dom';
import { distanceTo, history, nameOf, sizeOf, tracked, type Tracked } from './plan/obstacle_tracks';
import { Kind, type Point } from './protocol';
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

  constructor(private readonly shared: Shared) {}

  frame(): void {
    const { model, obstacle, hovered } = this.shared;
    const all = tracked(model);
    say(byId('obstacle-count'), all.length > 0 ? ` ${units.count(all.length)}` : '');
    if (this.list.clientWidth === 0) return;
    say(byId('obstacle-sum'), all.length > 0 ? countOf(all) : 'No obstacles.');
    const { vehicle } = model;
    const rows = obstacleRows(all, vehicle && [vehicle.north, vehicle.east]);
    const look = `${model.revision[Kind.obstacles]} ${model.revision[Kind.vehicle]} ${obstacle} ${hovered}`;
    if (look === this.drawn) return;
    const arranged = arrange(this.list, rows.slice(0, kRows).map((row, place) => this.row(row, place)));
    if (arranged) this.drawn = look;
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
