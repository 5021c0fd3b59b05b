/**
 * Saving: what the page shows as files: the chart as a picture, the track and the obstacles as tables (CSV), the
 * obstacles, route, fence and mission as GeoJSON (WGS 84, which needs the origin of the run), and a link to this moment
 * and section of the chart. Everything is made in the browser, without the network.
 */
import { toast } from './connection';
import { byId, make } from './dom';
import { geoPlace } from './geo';
import type { Model } from './model';
import { tracked } from './plan/obstacle_tracks';
import type { PlanView } from './plan/plan';
import type { Point } from './protocol';
import * as units from './units';
import type { Shared } from './view';

const number = (value: number | undefined, digits: number): string =>
  value === undefined || !Number.isFinite(value) ? '' : value.toFixed(digits);
const cell = (text: string): string => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
const table = (rows: readonly (readonly string[])[]): string => rows.map((row) => row.map(cell).join(',')).join('\n') + '\n';

/** Latitude and longitude, if the run has an origin. */
function degrees(model: Model, [north, east]: Point): string[] {
  if (!model.scene?.origin) return [];
  const { latitude, longitude } = geoPlace(model.scene.origin, north, east);
  return [latitude.toFixed(7), longitude.toFixed(7)];
}
const named = (model: Model): string[] => (model.scene?.origin ? ['latitude_deg', 'longitude_deg'] : []);

export function trackTable(model: Model): string {
  const rows = [['time_s', 'north_m', 'east_m', 'depth_m', ...named(model)]];
  for (const [, { places }] of [...model.track].sort(([a], [b]) => a - b)) {
    for (let i = 0; i + 3 < places.length; i += 4) {
      const [s, north, east, down] = [places[i]!, places[i + 1]!, places[i + 2]!, places[i + 3]!];
      rows.push([number(s, 2), number(north, 3), number(east, 3), number(down, 3), ...degrees(model, [north, east])]);
    }
  }
  return table(rows);
}

/** The obstacles in words, one a row, below the names of the columns. */
export function obstacleCells(model: Model): string[][] {
  const rows = [['number', 'kind', 'extent_m', 'existence', 'in_scan', 'first_seen_s', 'last_seen_s', 'north_m', 'east_m', ...named(model)]];
  for (const { number: own, outlines } of tracked(model)) {
    const facts = model.obstacles.find((o) => o.number === own);
    const middle = centre(outlines.flat());
    rows.push([
      String(own ?? ''),
      facts?.kind ?? '',
      number(facts?.extent, 2),
      number(facts?.existence, 3),
      facts ? String(facts.inScan) : '',
      number(facts?.since, 1),
      number(facts?.seen, 1),
      number(middle[0], 2),
      number(middle[1], 2),
      ...degrees(model, middle),
    ]);
  }
  return rows;
}
/** All signals over the time of the run: those that a plot can show. */
export function signalTable({ signals }: Model): string {
  const { at, all } = signals;
  const rows = [['time_s', ...all.map(({ name, unit }) => `${name} (${unit})`)]];
  at.forEach((s, i) => rows.push([number(s, 2), ...all.map(({ values }) => number(values[i] ?? undefined, 3))]));
  return table(rows);
}
export const obstacleTable = (model: Model): string => table(obstacleCells(model));

function centre(points: readonly Point[]): Point {
  const mean = (k: 0 | 1) => points.reduce((sum, p) => sum + p[k], 0) / Math.max(1, points.length);
  return [mean(0), mean(1)];
}

/** Null: the run has no origin. */
export function geoJson(model: Model): string | null {
  const { scene, way } = model;
  const origin = scene?.origin;
  if (!origin) return null;
  const at = ([north, east]: readonly number[]): number[] => {
    const { latitude, longitude } = geoPlace(origin, north!, east!);
    return [Number(longitude.toFixed(7)), Number(latitude.toFixed(7))];
  };
  const ring = (outline: readonly Point[]) => [[...outline, outline[0]!].map(at)];
  const feature = (type: string, coordinates: unknown, properties: object) => ({
    type: 'Feature',
    properties,
    geometry: { type, coordinates },
  });
  const features = tracked(model).flatMap(({ number: own, outlines }) =>
    outlines
      .filter((outline) => outline.length > 2)
      .map((outline) => feature('Polygon', ring(outline), { what: 'obstacle', number: own, kind: model.obstacles.find((o) => o.number === own)?.kind })),
  );
  if (scene.fence.length > 2) features.push(feature('Polygon', ring(scene.fence), { what: 'fence' }));
  if (way && way.points.length > 1) features.push(feature('LineString', way.points.map(at), { what: 'route' }));
  for (const point of scene.mission) features.push(feature('Point', at(point.at), { what: 'mission point', name: point.name }));
  return JSON.stringify({ type: 'FeatureCollection', features });
}

/** The moment and the section of the chart of a link: "#t=61.5&n=12.0&e=3.5&s=0.25". */
export interface Place {
  t: number | undefined;
  n: number | undefined;
  e: number | undefined;
  s: number | undefined;
}
export function placeOf(hash: string): Place {
  const given = new URLSearchParams(hash.replace(/^#/, ''));
  const of = (key: string) => {
    const value = Number(given.get(key) ?? NaN);
    return Number.isFinite(value) ? value : undefined;
  };
  return { t: of('t'), n: of('n'), e: of('e'), s: of('s') };
}

export class Saving {
  private readonly menu = byId<HTMLDialogElement>('save');

  constructor(
    private readonly shared: Shared,
    private readonly plan: PlanView,
  ) {
    byId('plan-save').addEventListener('click', () => this.open());
    byId('save-close').addEventListener('click', () => this.menu.close());
    this.menu.addEventListener('click', (event) => event.target === this.menu && this.menu.close());
    const { model } = shared;
    const does: Record<string, () => void> = {
      'save-png': () => this.picture(),
      'save-track': () => this.save('track.csv', 'text/csv', trackTable(model)),
      'save-signals': () => this.save('signals.csv', 'text/csv', signalTable(model)),
      'save-obstacles': () => this.save('obstacles.csv', 'text/csv', obstacleTable(model)),
      'save-geojson': () => this.save('chart.geojson', 'application/geo+json', geoJson(model) ?? ''),
      'save-link': () => void this.link(),
    };
    for (const [id, act] of Object.entries(does)) byId(id).addEventListener('click', act);
  }

  private open(): void {
    byId<HTMLButtonElement>('save-geojson').disabled = !this.shared.model.scene?.origin;
    this.menu.showModal();
  }

  private async link(): Promise<void> {
    const { north, east, scale } = this.plan.section;
    const hash = `t=${this.shared.model.now.toFixed(1)}&n=${north.toFixed(1)}&e=${east.toFixed(1)}&s=${scale.toPrecision(3)}`;
    history.replaceState(null, '', `#${hash}`);
    this.menu.close();
    try {
      await navigator.clipboard.writeText(location.href);
      toast('The link is copied: it shows this moment and this section.');
    } catch {
      toast('The address of the page shows this moment and this section: copy it.');
    }
  }

  private picture(): void {
    byId<HTMLCanvasElement>('plan-canvas').toBlob((blob) => blob && this.save('chart.png', 'image/png', blob));
  }

  private save(name: string, type: string, content: string | Blob): void {
    const { scene, now } = this.shared.model;
    const title = (scene?.title || 'isobath').replaceAll(/[^\p{L}\p{N}]+/gu, '-');
    const href = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type }));
    make('a', { href, download: `${title}-${units.elapsed(now, 0).replaceAll(':', '.')}-${name}` }).click();
    setTimeout(() => URL.revokeObjectURL(href), 10_000);
    this.menu.close();
  }
}
