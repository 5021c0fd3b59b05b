/**
 * The obstacle layer: obstacles of the last scan, remembered obstacles, and the earlier positions of these.
 *
 * Shape tells them apart, so that colour is not needed. A piece of the last scan is filled; its outline is dashed if it
 * is doubtful. A remembered one has a dotted outline, which fades the longer it is unseen. A thin line from a ring
 * shows the earlier positions of its centre. A body that moves has an arrow to where its velocity takes it in ten
 * seconds. An obstacle has one label with its number, however many pieces it has.
 */
import { age, metres } from '../units';
import type { Piece } from '../items';
import type { Model } from '../model';
import type { Point } from '../protocol';
import { middle, spread } from './chart_layers';
import { label, stroke, trace, type Pen } from './pen';
import { distanceTo, lastSeen, marginOf, type Tracked } from './obstacle_tracks';

/** Below this existence probability the outline of a piece is dashed. */
const kSure = 0.5;
/** s: after this time unseen a remembered piece is palest. */
const kPale = 120;
/** m a pixel: without labels, numbers only, and with all that is known of the obstacle. */
const kNoLabels = 0.4;
const kNumbersOnly = 0.18;
const kCrowd = 60;
/** s: how far ahead the arrow of a moving body reaches. */
const kArrow = 10;
const kNamedOfACrowd = 12;

export function drawObstacles(pen: Pen, model: Model, all: readonly Tracked[], pointed: Tracked | null): void {
  for (const { id, trail } of model.pieces) if (id !== undefined) drawTrailOf(pen, trail);
  for (const piece of model.pieces) {
    if (piece.outline.length === 0) continue;
    if (piece.id === undefined) drawSeen(pen, piece);
    else drawRemembered(pen, piece, Math.max(0, model.now - (piece.seen ?? model.now)));
  }
  for (const piece of model.pieces) drawVelocity(pen, piece);
  for (const t of namedOf(pen, model, all)) drawName(pen, model, t);
  if (pointed) point(pen, pointed);
}

/** The obstacles that are labelled; in a crowd at small scale, only those nearest to the vehicle. */
function namedOf({ camera }: Pen, { vehicle }: Model, all: readonly Tracked[]): readonly Tracked[] {
  if (camera.scale > kNoLabels) return [];
  const numbered = all.filter(({ number }) => number !== undefined);
  if (numbered.length <= kCrowd || camera.scale <= 0.06) return numbered;
  if (!vehicle) return numbered.slice(0, kNamedOfACrowd);
  const here: Point = [vehicle.north, vehicle.east];
  const far = new Map(numbered.map((t) => [t, distanceTo(t, here).metres]));
  return [...numbered].sort((a, b) => far.get(a)! - far.get(b)!).slice(0, kNamedOfACrowd);
}

function drawName(pen: Pen, model: Model, t: Tracked): void {
  const outline = t.outlines[0]!;
  const [north, east] = middle(outline);
  const above = pen.camera.y(north, east) - spread(pen, outline) / 2 - 10;
  const colour = t.seen.length > 0 && t.seen.every(({ behind }) => behind) ? pen.paint.behind : pen.paint.obstacle;
  label(pen, labelOf(t, model, pen.camera.scale < kNumbersOnly), pen.camera.x(north, east), above, colour);
}

/** "#3"; near by "#3 extended 12.4 m, 14.2 m away", or if only remembered "#3 compact 0.8 m, ± 1.5 m, 12 s ago". */
export function labelOf(t: Tracked, { now, vehicle }: Model, near: boolean): string {
  const name = `#${t.number}`;
  if (!near) return name;
  const parts = [[name, t.whole?.kind ?? '', t.whole?.extent === undefined ? '' : metres(t.whole.extent)]];
  if (t.seen.length > 0) {
    if (vehicle) parts.push([`${metres(distanceTo(t, [vehicle.north, vehicle.east]).metres)} away`]);
  } else {
    parts.push([`± ${metres(marginOf(t))}`]);
    const seen = lastSeen(t);
    if (seen !== undefined) parts.push([`${age(now - seen)} ago`]);
  }
  return parts.map((part) => part.filter((word) => word !== '').join(' ')).join(', ');
}

function drawSeen(pen: Pen, piece: Piece): void {
  const { drawing, paint } = pen;
  const existence = piece.existence ?? 1;
  trace(pen, piece.outline, true);
  drawing.fillStyle = paint.obstacleFill;
  drawing.globalAlpha = 0.25 + 0.75 * existence;
  drawing.fill();
  stroke(pen, {
    colour: piece.behind ? paint.behind : paint.obstacle,
    width: 2,
    dash: existence < kSure ? [4, 3] : [],
  });
  drawing.globalAlpha = 1;
}

function drawVelocity(pen: Pen, { outline, velocity }: Piece): void {
  if (!velocity || outline.length === 0) return;
  const { drawing, camera, paint } = pen;
  const from = middle(outline);
  const to: Point = [from[0] + kArrow * velocity[0], from[1] + kArrow * velocity[1]];
  const [x, y] = [camera.x(...to), camera.y(...to)];
  const along = Math.atan2(y - camera.y(...from), x - camera.x(...from));
  for (const [colour, width] of [[paint.halo, 5] as const, [paint.obstacle, 2] as const]) {
    trace(pen, [from, to], false);
    for (const side of [-0.45, 0.45]) {
      drawing.moveTo(x, y);
      drawing.lineTo(x - 9 * Math.cos(along + side), y - 9 * Math.sin(along + side));
    }
    stroke(pen, { colour, width });
  }
}

/** A dotted outline where navigation put it when it was seen; a pale band shows how far it may extend by now. */
function drawRemembered(pen: Pen, { outline, margin }: Piece, unseen: number): void {
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

/** Marks the obstacle that the readout describes, with all its pieces. */
function point(pen: Pen, { outlines }: Tracked): void {
  for (const outline of outlines) {
    trace(pen, outline, true);
    stroke(pen, { colour: pen.paint.halo, width: 5 });
    trace(pen, outline, true);
    stroke(pen, { colour: pen.paint.ink, width: 2 });
  }
}
