/** The draft on the chart: its points and fence, and the way that the program has planned for it, with its margins. */
import type { Preview } from '../preview';
import type { Point } from '../protocol';
import * as units from '../units';
import type { Draft } from './draft';
import { label, stroke, trace, words, type Pen } from './pen';

const kHalf = 8;
const kWayDash = [12, 4, 3, 4];

export interface DrawnDraft {
  draft: Draft;
  /** null: the program has not answered the newest change yet. */
  preview: Preview | null;
  edits: 'points' | 'fence';
  chosen: number | null;
  vehicle: Point | null;
}

export function drawDraft(pen: Pen, drawn: DrawnDraft): void {
  drawFence(pen, drawn);
  const { draft, preview, edits, chosen, vehicle } = drawn;
  if (preview && !preview.problem) drawLegs(pen, draft, preview, vehicle);
  else drawStraight(pen, [...(vehicle ? [vehicle] : []), ...draft.points.map(({ at }) => at)]);
  draft.points.forEach(({ at, name }, i) => {
    const lost = preview !== null && !preview.problem && preview.legs[i]?.way.length === 0;
    square(pen, at, lost ? pen.paint.obstacle : pen.paint.way, edits === 'points' && chosen === i);
    const [x, y] = [pen.camera.x(...at), pen.camera.y(...at)];
    words(pen, name || String(i + 1), x + kHalf + 6, y - kHalf - 4, lost ? pen.paint.obstacle : pen.paint.way);
  });
}

function drawFence(pen: Pen, { draft, edits, chosen }: DrawnDraft): void {
  const { paint } = pen;
  if (draft.fence.length > 1) {
    trace(pen, draft.fence, draft.fence.length > 2);
    stroke(pen, { colour: paint.halo, width: 5 });
    trace(pen, draft.fence, draft.fence.length > 2);
    stroke(pen, { colour: paint.fence, width: 2, dash: [7, 5] });
  }
  if (edits !== 'fence') return;
  draft.fence.forEach((at, i) => square(pen, at, paint.fence, chosen === i));
}

/** Before the program has answered: straight from point to point, thin, as nothing is known of it. */
function drawStraight(pen: Pen, places: readonly Point[]): void {
  if (places.length < 2) return;
  trace(pen, places, false);
  stroke(pen, { colour: pen.paint.way, width: 1.2, dash: [2, 5] });
}

function drawLegs(pen: Pen, draft: Draft, { legs, clearance }: Preview, vehicle: Point | null): void {
  const { camera, paint } = pen;
  let from = vehicle;
  legs.forEach(({ way, margin }, i) => {
    const to = draft.points[i]?.at;
    if (way.length < 2) {
      if (!from || !to) return;
      trace(pen, [from, to], false);
      stroke(pen, { colour: paint.obstacle, width: 1.5, dash: [2, 6] });
      label(pen, '▲ no way', ...middleOf(pen, [from, to]), paint.obstacle);
      return;
    }
    from = way[way.length - 1]!;
    trace(pen, way, false);
    stroke(pen, { colour: paint.halo, width: 6 });
    trace(pen, way, false);
    stroke(pen, { colour: paint.way, width: 2.4, dash: kWayDash });
    for (const corner of way.slice(1, -1)) {
      pen.drawing.beginPath();
      pen.drawing.arc(camera.x(...corner), camera.y(...corner), 3, 0, 2 * Math.PI);
      pen.drawing.fillStyle = paint.way;
      pen.drawing.fill();
    }
    if (margin === undefined) return;
    const tight = margin < clearance - 0.1;
    const said = `${tight ? '▲ ' : ''}margin ${units.metres(Math.max(0, margin))}`;
    label(pen, said, ...middleOf(pen, way), tight ? paint.obstacle : paint.way);
  });
}

/** The middle of the longest piece, beside the line. */
function middleOf({ camera }: Pen, way: readonly Point[]): [number, number] {
  let best: [number, number] = [0, 0];
  let longest = -1;
  for (let i = 1; i < way.length; ++i) {
    const [a, b] = [way[i - 1]!, way[i]!];
    const long = Math.hypot(b[0] - a[0], b[1] - a[1]);
    if (long <= longest) continue;
    longest = long;
    best = [camera.x((a[0] + b[0]) / 2, (a[1] + b[1]) / 2), camera.y((a[0] + b[0]) / 2, (a[1] + b[1]) / 2) + 14];
  }
  return best;
}

function square(pen: Pen, at: Point, colour: string, chosen: boolean): void {
  const { camera, drawing, paint } = pen;
  const [x, y] = [camera.x(...at), camera.y(...at)];
  drawing.beginPath();
  drawing.rect(x - kHalf, y - kHalf, 2 * kHalf, 2 * kHalf);
  drawing.fillStyle = chosen ? colour : paint.halo;
  drawing.fill();
  stroke(pen, { colour: paint.halo, width: 5 });
  drawing.beginPath();
  drawing.rect(x - kHalf, y - kHalf, 2 * kHalf, 2 * kHalf);
  stroke(pen, { colour, width: 2.4 });
}

/** A place that was pressed, to which the vehicle may be sent. */
export function drawPressed(pen: Pen, at: Point): void {
  const { camera, paint } = pen;
  const [x, y] = [camera.x(...at), camera.y(...at)];
  for (const [colour, width] of [[paint.halo, 5] as const, [paint.way, 2] as const]) {
    pen.drawing.beginPath();
    for (const [dx, dy] of [[1, 0], [0, 1]] as const) {
      pen.drawing.moveTo(x - 10 * dx, y - 10 * dy);
      pen.drawing.lineTo(x + 10 * dx, y + 10 * dy);
    }
    stroke(pen, { colour, width });
  }
}
