/** PlanView: the chart with everything that the vehicle knows. */
import { byId, context, fit, make, mark, pixelRatio, say } from '../dom';
import { geoPlace } from '../geo';
import type { Decision } from '../items';
import { DepthFlag, Kind, type Point } from '../protocol';
import * as units from '../units';
import type { Shared, View } from '../view';
import { alongLine } from './along_line';
import { Camera } from './camera';
import { drawBodies, drawFences, drawLand, drawMission, middle } from './chart_layers';
import { DepthLayer, type DepthShows } from './depth_layer';
import { drawTrail, SampleLayer } from './echo_layer';
import { drawGrid, drawGridNumbers, drawNorthArrow, drawRuler, drawScaleBar, rulerText, type Ruler } from './furniture';
import { listen, type Gestured } from './gestures';
import { GridLayer } from './grid_layer';
import { Layers, type LayerName } from './layers';
import * as moving from './moving_layers';
import { drawObstacles } from './obstacle_layer';
import * as tracks from './obstacle_tracks';
import type { Pen } from './pen';
import { meeting } from './prediction';
import { drawMeeting, drawPredicted, drawTimesAhead, moversOf } from './prediction_layer';
import { drawSounds } from './sound_layer';
import { DepthScale } from './depth_scale';

/** px: a touch within this distance selects an obstacle. */
const kTouch = 14;
/** m: obstacles within this distance of the ruler are told. */
const kBesideRuler = 20;
/** m: where less than this is to be shown, as of a run that has just begun, so much more is shown on each side, unless the
 * range of a sonar is known. */
const kBegun = 30;
/** m: a sonar that reaches farther is shown up to here. */
const kFar = 300;

/** What edits on the chart. While it is at work, a press and a drag are for it. */
export interface ChartEditor {
  /** Whether its draft is drawn instead of the mission. */
  readonly replacesMission: boolean;
  /** True: it has taken hold of something, which follows the pointer. */
  grasp(camera: Camera, x: number, y: number): boolean;
  pull(at: Point): void;
  release(): void;
  /** True: the press was for it. */
  tap(camera: Camera, x: number, y: number): boolean;
  draw(pen: Pen): void;
  told(camera: Camera): string;
}

export class PlanView implements View, Gestured {
  editor: ChartEditor | null = null;
  private readonly canvas = byId<HTMLCanvasElement>('plan-canvas');
  private readonly readout = byId('plan-readout');
  private readonly followButton = byId<HTMLButtonElement>('plan-follow');
  private readonly upButton = byId<HTMLButtonElement>('plan-up');
  private readonly rulerButton = byId<HTMLButtonElement>('plan-ruler');
  private readonly camera = new Camera();
  private readonly depth: DepthLayer;
  private readonly depthScale: DepthScale;
  private readonly grid = new GridLayer();
  private readonly samples = new SampleLayer();
  private readonly layers: Layers;
  private followed = true;
  private headUp = false;
  private ruler: Ruler | null = null;
  private measuring = false;
  private pointer: [number, number] | null = null;
  /** The position of a tapped obstacle without a number; one with a number is shared with the list. */
  private picked: [number, number] | null = null;
  private shown = '';
  private painted = -1;
  private placed = false;
  /** Whether the scale is a guess: no sonar had stated its range yet, and the user has not moved the chart. */
  private guessed = false;

  constructor(private readonly shared: Shared) {
    this.depth = new DepthLayer(shared.model, shared.theme);
    this.layers = new Layers(byId('plan-layers'), () => this.touch());
    byId('plan-hidden').addEventListener('click', () => this.layers.showSafety());
    this.depthScale = new DepthScale(byId('depth-scale'));
    listen(this.canvas, this);
    this.followButton.addEventListener('click', () => this.follow(!this.followed));
    this.upButton.addEventListener('click', () => this.turnUp());
    this.rulerButton.addEventListener('click', () => this.measure(!this.measuring));
    byId('plan-in').addEventListener('click', () => this.zoomBy(1.5));
    byId('plan-out').addEventListener('click', () => this.zoomBy(1 / 1.5));
    byId('plan-fit').addEventListener('click', () => this.showAll());
    const legend = byId<HTMLButtonElement>('plan-legend');
    const fold = (open: boolean) => {
      byId('plan-legend-box').hidden = !open;
      legend.setAttribute('aria-expanded', String(open));
    };
    legend.addEventListener('click', () => fold(byId('plan-legend-box').hidden !== false));
    fold(matchMedia('(min-width: 1700px)').matches);
    const shows = byId<HTMLSelectElement>('depth-shows');
    shows.addEventListener('change', () => {
      this.depth.shows = shows.value as DepthShows;
      shared.redraw();
    });
  }

  frame(): void {
    const { model, theme } = this.shared;
    if (this.canvas.clientWidth < 20 || this.canvas.clientHeight < 20) return;
    const resized = fit(this.canvas);
    const { obstacle, hovered } = this.shared;
    const look = `${model.revision.join()} ${this.decision?.number} ${obstacle} ${hovered}`;
    if (!this.dirty && !resized && look === this.shown && this.painted === theme.revision) return;
    this.dirty = false;
    this.shown = look;
    if (this.painted !== theme.revision) this.layers.paint(theme.paint);
    this.painted = theme.revision;
    this.camera.width = this.canvas.clientWidth;
    this.camera.height = this.canvas.clientHeight;
    this.steer();
    this.draw();
    this.tell();
  }
  private dirty = true;

  /** Draws at the next frame though the model has not changed. */
  refresh(): void {
    this.touch();
  }
  /** Requests a redraw after a change of this view alone. */
  private touch(): void {
    this.dirty = true;
    this.shared.redraw();
  }

  private steer(): void {
    const { vehicle, scene, clock } = this.shared.model;
    if (!this.placed && (vehicle || scene) && this.camera.width > 50) {
      this.placed = true;
      this.showAll();
      this.guessed = this.range === 0 && (scene?.mission.length ?? 0) + (scene?.fence.length ?? 0) === 0;
      const over = clock !== null && !clock.live && !clock.playing && clock.now >= clock.end;
      if (vehicle && !over) this.follow(true);
    }
    if (this.guessed && this.range > 0) {
      this.guessed = false;
      const { followed } = this;
      this.showAll();
      this.follow(followed);
    }
    if (vehicle && this.followed) {
      this.camera.north = vehicle.north;
      this.camera.east = vehicle.east;
    }
    this.camera.turn = this.headUp && vehicle ? vehicle.heading : 0;
    this.camera.settle();
  }

  /** The decision that the log points at, else the selected one. */
  private get decision(): Decision | null {
    return this.shared.pointedDecision ?? this.shared.selected;
  }

  private draw(): void {
    const { model, theme } = this.shared;
    const { camera, layers, decision } = this;
    const drawing = context(this.canvas);
    const ratio = pixelRatio();
    const pen: Pen = { drawing, camera, paint: theme.paint, taken: [] };
    drawing.setTransform(ratio, 0, 0, ratio, 0, 0);
    drawing.fillStyle = theme.paint.water;
    drawing.fillRect(0, 0, camera.width, camera.height);
    const { scene } = model;
    const layer = (name: LayerName, there: boolean, paint: () => void) => {
      layers.offer(name, there);
      if (there && layers.shows(name)) paint();
    };
    layer('depth', this.depth.any, () => this.depth.draw(pen, model.revision[Kind.depth]!));
    layer('land', (scene?.land.length ?? 0) + (scene?.charted.length ?? 0) > 0, () => drawLand(pen, scene!));
    drawGrid(pen);
    layer('grid', model.grid !== null, () => this.grid.draw(pen, model.grid!));
    layer('samples', model.sonars.size > 0, () => this.samples.draw(pen, model));
    const edited = this.editor?.replacesMission === true;
    layer('fence', !!scene && scene.fence.length + scene.keepOut.length > 0, () => edited || drawFences(pen, scene!));
    layer(
      'oldWays',
      model.decisions.some(({ way }) => way.length > 1),
      () => moving.drawOldWays(pen, model),
    );
    layer('mission', (scene?.mission.length ?? 0) > 0, () => edited || drawMission(pen, scene!, model.way?.target));
    layer('track', model.track.size > 0, () => moving.drawTrack(pen, model));
    layer('echoes', model.sonars.size > 0, () => drawTrail(pen, model));
    layer('bodies', (scene?.bodies.length ?? 0) > 0, () => drawBodies(pen, scene!));
    const movers = moversOf(model, decision);
    layer('predicted', movers.length > 0, () => drawPredicted(pen, movers));
    layer('obstacles', true, () => drawObstacles(pen, model, tracks.tracked(model), this.pointed()));
    layer('sounds', model.sounds.length > 0, () => drawSounds(pen, model));
    layer('way', model.way !== null, () => moving.drawWay(pen, model));
    if (decision) moving.drawDecision(pen, decision);
    this.editor?.draw(pen);
    layer('partners', model.partners.size > 0, () => moving.drawPartners(pen, model));
    layer('vehicle', true, () => moving.drawVehicle(pen, model));
    if (decision) drawMeeting(pen, model, decision);
    layer('predicted', movers.length > 0, () => drawTimesAhead(pen, movers));
    if (this.ruler) drawRuler(pen, this.ruler);
    drawGridNumbers(pen);
    drawScaleBar(pen);
    drawNorthArrow(pen, 34, 52);
    const hidden = layers.hiddenSafety;
    byId('plan-hidden').hidden = hidden.length === 0;
    say(byId('plan-hidden'), `▲ Hidden: ${hidden.join(', ')}. Show`);
    const datum = scene?.datum ?? '';
    this.depthScale.show(theme.paint, this.depth, datum, this.depth.any && layers.shows('depth'));
  }

  /** The line below the chart: what is under the pointer, else the position of the vehicle. */
  private tell(): void {
    const { scene, vehicle } = this.shared.model;
    const at = this.pointer
      ? this.camera.place(...this.pointer)
      : vehicle
        ? ([vehicle.north, vehicle.east] as const)
        : null;
    mark(this.canvas, 'north', this.camera.north.toFixed(2));
    mark(this.canvas, 'east', this.camera.east.toFixed(2));
    mark(this.canvas, 'scale', this.camera.scale.toFixed(4));
    const numbered = tracks.tracked(this.shared.model).filter(({ number }) => number !== undefined);
    const met = this.decision && meeting(this.decision);
    mark(this.canvas, 'meeting', met ? `vehicle${met.body ? ' body' : ''}` : '');
    mark(this.canvas, 'draft', this.editor?.told(this.camera) ?? '');
    const movers = this.layers.shows('predicted') ? moversOf(this.shared.model, this.decision) : [];
    mark(this.canvas, 'predicted', movers.map(({ number }) => number ?? '?').join());
    mark(this.canvas, 'obstacles', numbered.map((t) => this.told(t)).join(';'));
    if (!at) return say(this.readout, 'no position yet');
    const parts = [`${this.pointer ? 'Cursor' : 'Vehicle'} N ${units.metres(at[0])}, E ${units.metres(at[1])}`];
    if (scene?.origin) {
      const { latitude, longitude } = geoPlace(scene.origin, at[0], at[1]);
      parts.push(`${units.latitude(latitude)} ${units.longitude(longitude)}`);
    }
    const bottom = this.shared.model.depthAt(at[0], at[1]);
    if (bottom) {
      const known = (bottom.flags & DepthFlag.measured) !== 0 ? 'measured' : 'charted';
      parts.push(`depth ${units.metres(bottom.depth)}, ${known}, confidence ${bottom.confidence} of 20`);
    }
    if (this.pointer && vehicle) {
      const [n, e] = [at[0] - vehicle.north, at[1] - vehicle.east];
      parts.push(`${units.metres(Math.hypot(n, e))}, ${units.bearing(Math.atan2(e, n))} from the vehicle`);
    }
    const pointed = this.pointed();
    const here = vehicle ? ([vehicle.north, vehicle.east] as const) : null;
    if (pointed) parts.unshift(tracks.words(pointed, this.shared.model.now, here && [...here]));
    if (this.ruler) {
      const { from, to } = this.ruler;
      const depthAt = this.depth.any ? (p: readonly [number, number]) => this.shared.model.depthAt(...p)?.depth ?? null : null;
      const known = alongLine(from, to, depthAt, tracks.tracked(this.shared.model), kBesideRuler);
      parts.unshift(rulerText(this.ruler), ...known);
    }
    const spans = parts.map((part) => make('span', {}, part));
    if (this.readout.textContent !== parts.join('')) this.readout.replaceChildren(...spans);
  }

  /** The obstacle under the pointer, else the one that a list points at, else the selected one if it is still known. */
  private pointed(): tracks.Tracked | null {
    if (!this.layers.shows('obstacles')) return null;
    const all = tracks.tracked(this.shared.model);
    const under = this.pointer && this.obstacleAt(all, this.camera.place(...this.pointer));
    if (under) return under;
    const wanted = this.shared.hovered ?? this.shared.obstacle;
    if (wanted !== null) return all.find(({ number }) => number === wanted) ?? null;
    return this.picked && this.obstacleAt(all, this.picked);
  }
  /** Number and canvas position of an obstacle. */
  private told({ number, outlines }: tracks.Tracked): string {
    const [north, east] = middle(outlines[0]!);
    return `${number} ${this.camera.x(north, east).toFixed(0)} ${this.camera.y(north, east).toFixed(0)}`;
  }
  private obstacleAt(all: readonly tracks.Tracked[], at: [number, number]): tracks.Tracked | null {
    return tracks.trackedAt(all, at, kTouch * this.camera.scale);
  }

  drag(dx: number, dy: number): void {
    this.follow(false);
    this.guessed = false;
    this.camera.pan(dx, dy);
    this.touch();
  }
  zoom(factor: number, x: number, y: number): void {
    this.guessed = false;
    // In follow mode the vehicle stays at the centre.
    if (this.followed) this.camera.zoom(factor);
    else this.camera.zoom(factor, x, y);
    this.touch();
  }
  zoomBy(factor: number): void {
    this.guessed = false;
    this.camera.zoom(factor);
    this.touch();
  }
  panBy(right: number, up: number): void {
    this.drag(-right * 60, up * 60);
  }
  hover(at: [number, number] | null): void {
    this.pointer = at;
    const under = at && this.obstacleAt(tracks.tracked(this.shared.model), this.camera.place(...at));
    this.shared.hover(under?.number ?? null);
    this.touch();
  }
  tap(x: number, y: number): void {
    if (this.measuring || this.editor?.tap(this.camera, x, y)) return;
    const at = this.camera.place(x, y);
    const there = this.obstacleAt(tracks.tracked(this.shared.model), at);
    this.shared.obstacle = there?.number ?? null;
    this.picked = there && at;
    this.touch();
  }
  grasp(x: number, y: number): boolean {
    if (!this.measuring) return this.editor?.grasp(this.camera, x, y) ?? false;
    const from = this.camera.place(x, y);
    this.ruler = { from, to: from };
    this.touch();
    return true;
  }
  pull(x: number, y: number): void {
    if (!this.measuring) this.editor?.pull(this.camera.place(x, y));
    else if (this.ruler) this.ruler.to = this.camera.place(x, y);
    this.touch();
  }
  release(): void {
    this.editor?.release();
  }

  follow(on: boolean): void {
    this.followed = on;
    this.followButton.setAttribute('aria-pressed', String(on));
    this.touch();
  }
  togglePredicted(): void {
    this.layers.toggle('predicted');
  }
  toggleFollow(): void {
    this.follow(!this.followed);
  }
  measure(on: boolean): void {
    this.measuring = on;
    if (!on) this.ruler = null;
    this.rulerButton.setAttribute('aria-pressed', String(on));
    this.canvas.classList.toggle('measuring', on);
    this.touch();
  }
  get isMeasuring(): boolean {
    return this.measuring;
  }
  turnUp(): void {
    this.headUp = !this.headUp;
    this.upButton.setAttribute('aria-pressed', String(this.headUp));
    say(this.upButton, this.headUp ? 'Head up' : 'North up');
    this.touch();
  }

  /** The section that is shown. */
  get section(): { north: number; east: number; scale: number } {
    const { north, east, scale } = this.camera;
    return { north, east, scale };
  }
  showSection({ n, e, s }: { n: number | undefined; e: number | undefined; s: number | undefined }): void {
    if (n === undefined || e === undefined || s === undefined) return;
    this.placed = true;
    this.follow(false);
    [this.camera.north, this.camera.east] = [n, e];
    this.camera.zoom(this.camera.scale / Math.max(Camera.finest, s));
    this.touch();
  }

  /** A new run: the chart is framed again. */
  begin(): void {
    this.placed = this.guessed = false;
    this.picked = null;
    this.measure(false);
  }

  /** The range of the farthest-reaching sonar, m; 0: none is known. */
  private get range(): number {
    return Math.min(kFar, Math.max(0, ...[...this.shared.model.sonars.values()].map(({ reach }) => reach)));
  }

  /** Shows the fence, the mission, the vehicle and its track; without a mission, as far as the sonar looks, or the map. */
  showAll(): void {
    const { scene, vehicle, track } = this.shared.model;
    const places: (readonly [number, number])[] = [
      ...(scene?.fence ?? []),
      ...(scene?.mission.map(({ at }) => at) ?? []),
    ];
    if (vehicle) places.push([vehicle.north, vehicle.east]);
    for (const { places: piece } of track.values()) {
      for (let i = 0; i + 3 < piece.length; i += 4) places.push([piece[i + 1]!, piece[i + 2]!]);
    }
    if (places.length < 2 && this.range === 0) places.push(...this.depth.corners);
    if (places.length === 0) return;
    const range = (k: 0 | 1): [number, number] =>
      places.reduce<[number, number]>(([a, b], p) => [Math.min(a, p[k]), Math.max(b, p[k])], [Infinity, -Infinity]);
    this.follow(false);
    const [north, east] = [range(0), range(1)];
    const extent = Math.max(north[1] - north[0], east[1] - east[0]);
    const planned = (scene?.mission.length ?? 0) + (scene?.fence.length ?? 0) > 0;
    const margin = planned ? kBegun : this.range || kBegun;
    const least = extent < margin ? margin : 0;
    if (least > 0) this.camera.show([north[0] - least, north[1] + least], [east[0] - least, east[1] + least]);
    else this.camera.show(north, east, 0.08);
    this.touch();
  }

  /** Pans to an obstacle, and zooms only if it is larger than the chart or too small to be seen. */
  showObstacle(number: number): void {
    const there = tracks.tracked(this.shared.model).find((t) => t.number === number);
    if (there) this.panTo(there.outlines.flat());
    this.touch();
  }

  showDecision(decision: Decision): void {
    const places = decision.obstacle ? [decision.obstacle] : decision.way;
    if (places.length > 0) this.panTo([...places, ...decision.way]);
    this.touch();
  }

  /** Shows these places; the scale stays if they fit it. */
  private panTo(places: readonly (readonly [number, number])[]): void {
    this.follow(false);
    const range = (k: 0 | 1): [number, number] => [
      Math.min(...places.map((p) => p[k])),
      Math.max(...places.map((p) => p[k])),
    ];
    const [n, e] = [range(0), range(1)];
    const seen = Math.min(this.camera.width, this.camera.height) * this.camera.scale;
    if (Math.max(n[1] - n[0], e[1] - e[0]) > seen || seen > 400) this.camera.show(n, e, 0.2);
    else [this.camera.north, this.camera.east] = [(n[0] + n[1]) / 2, (e[0] + e[1]) / 2];
  }
}
