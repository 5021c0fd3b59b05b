/**
 * ObstacleList: the obstacles as people count them, nearest first, each with number, kind, extent, distance and bearing
 * from the vehicle. Pointing at one marks it on the chart; a selected one is shown there.
 */
import { byId, make, say } from './dom';
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
    this.drawn = look;
    const focused = (document.activeElement as HTMLElement | null)?.closest<HTMLElement>('[data-obstacle]')?.dataset
      .obstacle;
    this.list.replaceChildren(...rows.slice(0, kRows).map((row) => this.row(row)));
    if (focused) this.list.querySelector<HTMLElement>(`[data-obstacle="${focused}"] button`)?.focus();
  }

  private row({ tracked: t, away, bearing }: ObstacleRow): HTMLElement {
    const { model, obstacle, hovered } = this.shared;
    const chosen = t.number !== undefined && t.number === obstacle;
    const head = make(
      'span',
      { class: 'log-head' },
      make('span', { class: 'log-number' }, t.number === undefined ? '?' : String(t.number)),
      make('strong', {}, sizeOf(t) || nameOf(t)),
      make('span', { class: 'obstacle-away' }, `${units.metres(away)}, ${units.bearing(bearing)}`),
    );
    const button = make(
      'button',
      { type: 'button', class: 'log-row' },
      head,
      make('span', { class: 'log-reason' }, history(t, model.now).join(', ')),
    );
    button.setAttribute('aria-pressed', String(chosen));
    const marked = chosen || (t.number !== undefined && t.number === hovered);
    const item = make('li', { 'data-obstacle': t.number, class: marked ? 'chosen' : undefined }, button);
    if (t.number === undefined) return item;
    const number = t.number;
    button.addEventListener('click', () => this.shared.showObstacle(number));
    button.addEventListener('pointerenter', () => this.shared.hover(number));
    button.addEventListener('pointerleave', () => this.shared.hover(null));
    return item;
  }
}
