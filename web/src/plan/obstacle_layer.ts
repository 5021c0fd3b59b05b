/**
 * The obstacle layer: obstacles of the last scan, remembered obstacles, and the earlier positions of these.
 *
 * Shape tells them apart, so that colour is not needed. An obstacle of the last scan is filled; its outline is dashed
 * if it is doubtful. A remembered one has a dotted outline, which fades the longer it is unseen. A thin line from a
 * ring shows the earlier positions of its centre.
 */
import { age, metres, percent } from '../units';
import type { Obstacle } from '../items';
import type { Model } from '../model';
import type { Point } from '../protocol';
import { middle, spread } from './chart_layers';
import { label, stroke, trace, type Pen } from './pen';
import type { Tracked } from './obstacle_tracks';

/** Below this existence probability the outline of an obstacle is dashed. */
const kSure = 0.5;
/** s: after this time unseen an obstacle is palest. */
const kPale = 120;
const kCrowd = 60;
const kNamedOfACrowd = 12;

export function drawObstacles(pen: Pen, model: Model, pointed: Tracked | null): void {
  const named = namesFor(pen, model);
  for (const { id, trail } of model.obstacles) if (id !== undefined) drawTrailOf(pen, trail);
  for (const obstacle of model.obstacles) {
    if (obstacle.outline.length === 0) continue;
    const unseen = Math.max(0, model.now - (obstacle.seen ?? model.now));
    const colour = obstacle.id !== undefined ? drawRemembered(pen, obstacle, unseen) : drawSeen(pen, obstacle);
    if (!named.has(obstacle)) continue;
    const [north, east] = middle(obstacle.outline);
    const above = pen.camera.y(north, east) - spread(pen, obstacle.outline) / 2 - 10;
    const text = nameOf(obstacle, unseen, pen.camera.scale < 0.18);
    if (text) label(pen, text, pen.camera.x(north, east), above, colour);
  }
  if (pointed) point(pen, pointed);
}

/** Names each number once; in a crowd at small scale, only the numbers nearest to the vehicle. */
function namesFor({ camera }: Pen, { obstacles, vehicle }: Model): Set<Obstacle> {
  if (camera.scale > 0.4) return new Set();
  const drawn = obstacles.filter(({ outline }) => outline.length > 0);
  const byNumber = new Map<number, Obstacle>();
  for (const o of drawn) {
    const number = o.id ?? o.of;
    if (number !== undefined && !byNumber.has(number)) byNumber.set(number, o);
  }
  const numbered = [...byNumber.values()];
  if (drawn.length <= kCrowd || camera.scale <= 0.06) {
    return new Set([...numbered, ...drawn.filter((o) => (o.id ?? o.of) === undefined)]);
  }
  if (!vehicle) return new Set(numbered.slice(0, kNamedOfACrowd));
  const far = ({ outline }: Obstacle) => {
    const [north, east] = middle(outline);
    return Math.hypot(north - vehicle.north, east - vehicle.east);
  };
  return new Set(numbered.sort((a, b) => far(a) - far(b)).slice(0, kNamedOfACrowd));
}

function nameOf({ id, of, margin, existence, range, seen }: Obstacle, unseen: number, near: boolean): string {
  if (id !== undefined) {
    const ago = seen === undefined ? '' : `, ${age(unseen)} ago`;
    return `#${id}${near ? ` ± ${metres(margin)}${ago}` : ''}`;
  }
  const known = of === undefined ? [] : [`#${of}`];
  return [...known, ...(near ? [percent(existence ?? 1), metres(range)] : [])].join(', ');
}

function drawSeen(pen: Pen, obstacle: Obstacle): string {
  const { drawing, paint } = pen;
  const colour = obstacle.behind ? paint.behind : paint.obstacle;
  const existence = obstacle.existence ?? 1;
  trace(pen, obstacle.outline, true);
  drawing.fillStyle = paint.obstacleFill;
  drawing.globalAlpha = 0.25 + 0.75 * existence;
  drawing.fill();
  stroke(pen, { colour, width: 2, dash: existence < kSure ? [4, 3] : [] });
  drawing.globalAlpha = 1;
  return colour;
}

/** A dotted outline where navigation put it when it was seen; a pale band shows how far it may extend by now. */
function drawRemembered(pen: Pen, { outline, margin }: Obstacle, unseen: number): string {
  const { drawing, camera, paint } = pen;
  const fresh = 1 - 0.5 * Math.min(1, unseen / kPale);
  drawing.lineJoin = 'round';
  drawing.globalAlpha = 0.4 * fresh;
  trace(pen, outline, true);
  stroke(pen, { colour: paint.obstacleFill, width: Math.max(1, (2 * margin) / camera.scale) });
  drawing.globalAlpha = fresh;
  trace(pen, outline, true);
  stroke(pen, { colour: paint.obstacle, width: 1.5, dash: [1.5, 3] });
  drawing.globalAlpha = 1;
  return paint.obstacle;
}

/** Earlier positions, fading towards the first one. */
function drawTrailOf(pen: Pen, trail: readonly Point[]): void {
  const { drawing, camera, paint } = pen;
  const first = trail[0];
  if (!first || trail.length < 2) return;
  for (let i = 1; i < trail.length; ++i) {
    const piece = [trail[i - 1]!, trail[i]!];
    drawing.globalAlpha = 0.3 + (0.7 * i) / (trail.length - 1);
    trace(pen, piece, false);
    stroke(pen, { colour: paint.halo, width: 3.5 });
    trace(pen, piece, false);
    stroke(pen, { colour: paint.obstacle, width: 1.25 });
  }
  drawing.globalAlpha = 0.6;
  drawing.beginPath();
  drawing.arc(camera.x(...first), camera.y(...first), 2.5, 0, 2 * Math.PI);
  stroke(pen, { colour: paint.obstacle, width: 1.25 });
  drawing.globalAlpha = 1;
}

/** Marks the obstacle that the readout describes. */
function point(pen: Pen, { outlines }: Tracked): void {
  for (const outline of outlines) {
    trace(pen, outline, true);
    stroke(pen, { colour: pen.paint.halo, width: 5 });
    trace(pen, outline, true);
    stroke(pen, { colour: pen.paint.ink, width: 2 });
  }
}
