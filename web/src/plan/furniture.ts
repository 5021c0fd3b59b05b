/**
 * The furniture of a chart: a grid in metres with its numbers, a scale bar, a north arrow and a ruler.
 */
import { bearing, metres, roundStep } from '../units';
import { kFont, stroke, trace, words, type Pen } from './pen';

export function drawGrid(pen: Pen): void {
  const { camera, drawing, paint } = pen;
  const step = roundStep(90 * camera.scale);
  const reach = camera.reach;
  const first = (middle: number) => Math.ceil((middle - reach) / step) * step;
  drawing.beginPath();
  for (let n = first(camera.north); n <= camera.north + reach; n += step) {
    drawing.moveTo(camera.x(n, camera.east - reach), camera.y(n, camera.east - reach));
    drawing.lineTo(camera.x(n, camera.east + reach), camera.y(n, camera.east + reach));
  }
  for (let e = first(camera.east); e <= camera.east + reach; e += step) {
    drawing.moveTo(camera.x(camera.north - reach, e), camera.y(camera.north - reach, e));
    drawing.lineTo(camera.x(camera.north + reach, e), camera.y(camera.north + reach, e));
  }
  stroke(pen, { colour: paint.grid, width: 1 });
}

/** Numbers of the grid at the left and upper edges; only while north is up. */
export function drawGridNumbers(pen: Pen): void {
  const { camera } = pen;
  if (camera.turn !== 0) return;
  const step = roundStep(90 * camera.scale);
  const [top, left] = camera.place(0, 0);
  const [bottom, right] = camera.place(camera.width, camera.height);
  const number = (v: number) => String(Math.round(v * 1000) / 1000).replace('-', '−');
  for (let n = Math.ceil(bottom / step) * step; n <= top; n += step) {
    const y = camera.y(n, 0);
    if (y > 90 && y < camera.height - 60) words(pen, `N ${number(n)}`, 6, y, pen.paint.faint);
  }
  for (let e = Math.ceil(left / step) * step; e <= right; e += step) {
    const x = camera.x(0, e);
    if (x > 75 && x < camera.width - 20) words(pen, `E ${number(e)}`, x, 10, pen.paint.faint, 'center');
  }
}

export function drawScaleBar(pen: Pen): void {
  const { camera, drawing, paint } = pen;
  const length = roundStep(70 * camera.scale);
  const px = length / camera.scale;
  const [x, y] = [14, camera.height - 20];
  drawing.fillStyle = paint.halo;
  drawing.fillRect(x - 8, y - 22, px + 52, 36);
  for (let part = 0; part < 4; ++part) {
    drawing.fillStyle = part % 2 === 0 ? paint.ink : paint.water;
    drawing.fillRect(x + (part * px) / 4, y, px / 4, 6);
  }
  drawing.strokeStyle = paint.ink;
  drawing.lineWidth = 1;
  drawing.strokeRect(x, y, px, 6);
  words(pen, '0', x, y - 9, paint.ink);
  words(pen, metres(length, length < 1 ? 2 : 0), x + px, y - 9, paint.ink, 'center');
}

export function drawNorthArrow(pen: Pen, x: number, y: number): void {
  const { camera, drawing, paint } = pen;
  drawing.save();
  drawing.translate(x, y);
  drawing.beginPath();
  drawing.arc(0, 0, 24, 0, 2 * Math.PI);
  drawing.fillStyle = paint.halo;
  drawing.fill();
  drawing.rotate(-camera.turn);
  for (const side of [-1, 1]) {
    drawing.beginPath();
    drawing.moveTo(0, -10);
    drawing.lineTo(side * 7, 16);
    drawing.lineTo(0, 11);
    drawing.closePath();
    drawing.fillStyle = side < 0 ? paint.ink : paint.water;
    drawing.fill();
    stroke(pen, { colour: paint.ink, width: 1 });
  }
  drawing.font = `bold ${kFont}`;
  drawing.textAlign = 'center';
  drawing.textBaseline = 'middle';
  drawing.fillStyle = paint.ink;
  drawing.fillText('N', 0, -17);
  drawing.restore();
}

export interface Ruler {
  from: [number, number];
  to: [number, number];
}
export const rulerText = ({ from, to }: Ruler): string => {
  const [n, e] = [to[0] - from[0], to[1] - from[1]];
  const length = Math.hypot(n, e);
  return `${metres(length, length < 10 ? 2 : 1)}, bearing ${bearing(Math.atan2(e, n))}`;
};

export function drawRuler(pen: Pen, ruler: Ruler): void {
  const { camera, drawing, paint } = pen;
  trace(pen, [ruler.from, ruler.to], false);
  stroke(pen, { colour: paint.halo, width: 5 });
  trace(pen, [ruler.from, ruler.to], false);
  stroke(pen, { colour: paint.ruler, width: 2 });
  for (const at of [ruler.from, ruler.to]) {
    drawing.beginPath();
    drawing.arc(camera.x(...at), camera.y(...at), 4, 0, 2 * Math.PI);
    drawing.fillStyle = paint.ruler;
    drawing.fill();
  }
  const [x, y] = [camera.x(...ruler.to), camera.y(...ruler.to)];
  words(
    pen,
    rulerText(ruler),
    Math.min(Math.max(90, x), camera.width - 90),
    y < 40 ? y + 20 : y - 16,
    paint.ruler,
    'center',
  );
}
