/** Pen: drawing in metres north and east on a canvas; shared by the layers of the plan view. */
import type { Paint } from '../theme';
import type { Camera } from './camera';

type Place = readonly [number, number, ...number[]];

export interface Pen {
  drawing: CanvasRenderingContext2D;
  camera: Camera;
  paint: Paint;
  /** Boxes that labels already occupy: left, top, right, bottom, px. */
  taken: [number, number, number, number][];
}

export function trace({ drawing, camera }: Pen, places: readonly Place[], closed: boolean): void {
  drawing.beginPath();
  for (const [north, east] of places) drawing.lineTo(camera.x(north, east), camera.y(north, east));
  if (closed) drawing.closePath();
}

export interface Line {
  colour: string;
  width?: number;
  dash?: readonly number[];
}
export function stroke({ drawing }: Pen, { colour, width = 1.5, dash = [] }: Line): void {
  drawing.strokeStyle = colour;
  drawing.lineWidth = width;
  drawing.setLineDash(dash as number[]);
  drawing.stroke();
  drawing.setLineDash([]);
}

export const kFont = '12px system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif';

/** Text with a halo, so that it is readable on any background. */
export function words(
  { drawing, paint }: Pen,
  text: string,
  x: number,
  y: number,
  colour = paint.ink,
  align: CanvasTextAlign = 'left',
): void {
  drawing.font = kFont;
  drawing.textAlign = align;
  drawing.textBaseline = 'middle';
  drawing.lineJoin = 'round';
  drawing.strokeStyle = paint.halo;
  drawing.lineWidth = 3.5;
  drawing.strokeText(text, x, y);
  drawing.fillStyle = colour;
  drawing.fillText(text, x, y);
}

/** Draws a label unless it would cover another one. Returns whether it was drawn. */
export function label(
  pen: Pen,
  text: string,
  x: number,
  y: number,
  colour: string,
  align: 'center' | 'left' = 'center',
): boolean {
  pen.drawing.font = kFont;
  const wide = pen.drawing.measureText(text).width;
  const from = align === 'center' ? x - wide / 2 : x;
  const box: [number, number, number, number] = [from - 2, y - 8, from + wide + 2, y + 8];
  if (pen.taken.some((t) => box[0] < t[2] && t[0] < box[2] && box[1] < t[3] && t[1] < box[3])) return false;
  pen.taken.push(box);
  words(pen, text, x, y, colour, align);
  return true;
}

/** Draws an image from one corner, turned by a heading in W; `size` is its height and width in metres. */
export function place(
  { drawing, camera }: Pen,
  image: CanvasImageSource,
  corner: readonly [number, number],
  heading: number,
  size: readonly [number, number],
): void {
  drawing.save();
  drawing.translate(camera.x(...corner), camera.y(...corner));
  drawing.rotate(heading - camera.turn);
  drawing.drawImage(image, 0, -size[0] / camera.scale, size[1] / camera.scale, size[0] / camera.scale);
  drawing.restore();
}
