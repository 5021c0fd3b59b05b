/**
 * The prediction layer: of bodies that move, the ellipse of twice the standard deviation of the position, and the
 * outlines at four times ahead, the paler the later. Only for bodies near the vehicle, so that a crowd stays readable.
 * And the closest approach that a decision tells of.
 */
import { age, metres } from '../units';
import type { Decision, Piece } from '../items';
import type { Model } from '../model';
import type { Point } from '../protocol';
import { middle } from './chart_layers';
import { kFont, label, stroke, trace, words, type Pen } from './pen';
import { ellipse, kAhead, meeting, predicted } from './prediction';

/** m: only bodies within this distance of the vehicle are drawn with more than their arrow. */
export const kNear = 40;
/** m a pixel: from here on the times ahead are not written. */
const kNoTimes = 0.25;
const kSigmas = 2;
const kRing = 8;

/**
 * The pieces of the last scan whose motion is drawn: those that move within kNear of the vehicle; while a decision shows
 * a closest approach, only its body.
 */
export function moversOf({ pieces, vehicle }: Model, decision: Decision | null): Piece[] {
  const only = decision && meeting(decision) ? decision.obstacleNumber : undefined;
  return pieces.filter(({ outline, velocity, number }) => {
    if (!velocity || outline.length === 0) return false;
    if (only !== undefined) return number === only;
    return !vehicle || outline.some(([n, e]) => Math.hypot(n - vehicle.north, e - vehicle.east) <= kNear);
  });
}

export function drawPredicted(pen: Pen, movers: readonly Piece[]): void {
  const { drawing, paint } = pen;
  for (const piece of movers) {
    for (const ahead of [...kAhead].reverse()) {
      trace(pen, predicted(piece, ahead), true);
      drawing.globalAlpha = paleness(ahead);
      drawing.fillStyle = paint.obstacleFill;
      drawing.fill();
      stroke(pen, { colour: paint.obstacle, width: 1.2 });
    }
    drawing.globalAlpha = 1;
    if (!piece.covariance) continue;
    trace(pen, ellipse(middle(piece.outline), piece.covariance, kSigmas), true);
    stroke(pen, { colour: paint.halo, width: 3 });
    trace(pen, ellipse(middle(piece.outline), piece.covariance, kSigmas), true);
    stroke(pen, { colour: paint.ink, width: 1.2, dash: [2, 2] });
  }
}

/** "5 s" at each predicted outline, where there is room. */
export function drawTimesAhead(pen: Pen, movers: readonly Piece[]): void {
  const { camera, paint } = pen;
  if (camera.scale > kNoTimes) return;
  for (const piece of movers) {
    for (const ahead of kAhead) {
      const [north, east] = middle(predicted(piece, ahead));
      label(pen, `${ahead} s`, camera.x(north, east), camera.y(north, east), paint.obstacle);
    }
  }
}

/** From 0.8 at 5 s to 0.2 at 20 s. */
const paleness = (ahead: number): number => 1 - ahead / (kAhead[kAhead.length - 1]! + kAhead[0]);

/** Where vehicle and body will be at the closest approach: two rings, a line between them, and the gap. */
export function drawMeeting(pen: Pen, model: Model, decision: Decision): void {
  const met = meeting(decision);
  const { approach } = decision;
  if (!met || !approach) return;
  const { camera, paint } = pen;
  const left = model.scene ? decision.time - model.scene.start + approach.in - model.now : approach.in;
  const said = `closest ${metres(Math.max(0, approach.gap))} ${left < 0 ? `${age(-left)} ago` : `in ${age(left)}`}`;
  if (met.body) {
    drawThen(pen, model, decision, met.body);
    trace(pen, [met.vehicle, met.body], false);
    stroke(pen, { colour: paint.halo, width: 5 });
    trace(pen, [met.vehicle, met.body], false);
    stroke(pen, { colour: paint.ink, width: 1.5, dash: [4, 3] });
    ring(pen, met.body, paint.obstacle);
  }
  ring(pen, met.vehicle, paint.decision);
  const to = met.body ?? met.vehicle;
  const [north, east] = middle([met.vehicle, to]);
  nameGap(pen, said, camera.x(north, east), camera.y(north, east));
}

/** Beside the line, on a box that covers what is below; where there is room, if there is any. */
function nameGap(pen: Pen, said: string, x: number, y: number): void {
  const { drawing, paint, taken } = pen;
  drawing.font = kFont;
  const half = drawing.measureText(said).width / 2 + 5;
  const box = (below: number): [number, number, number, number] => [x - half, y + below - 10, x + half, y + below + 10];
  const kPlaces = [kRing + 16, -kRing - 16, 2 * kRing + 34, -2 * kRing - 34];
  const free = (b: readonly number[]) =>
    !taken.some((t) => b[0]! < t[2] && t[0] < b[2]! && b[1]! < t[3] && t[1] < b[3]!);
  const below = kPlaces.find((place) => free(box(place))) ?? kPlaces[0]!;
  const at = box(below);
  taken.push(at);
  drawing.beginPath();
  drawing.roundRect(at[0], at[1], 2 * half, 20, 5);
  drawing.fillStyle = paint.halo;
  drawing.fill();
  stroke(pen, { colour: paint.ink, width: 1 });
  words(pen, said, x, y + below, paint.ink, 'center');
}

/** The outline of the body, as it is known now, at its place then. */
function drawThen(pen: Pen, { pieces }: Model, { obstacleNumber }: Decision, then: Point): void {
  for (const { number, outline, velocity } of pieces) {
    if (obstacleNumber === undefined || number !== obstacleNumber || !velocity || outline.length === 0) continue;
    const [n, e] = middle(outline);
    const moved = outline.map((p): Point => [p[0] - n + then[0], p[1] - e + then[1]]);
    trace(pen, moved, true);
    stroke(pen, { colour: pen.paint.obstacle, width: 1.5, dash: [4, 3] });
  }
}

function ring(pen: Pen, at: Point, colour: string): void {
  const { camera, drawing, paint } = pen;
  for (const [of, width] of [[paint.halo, 5] as const, [colour, 2.2] as const]) {
    drawing.beginPath();
    drawing.arc(camera.x(...at), camera.y(...at), kRing, 0, 2 * Math.PI);
    stroke(pen, { colour: of, width });
  }
}
