/** Text in the 3-D view, which has the same size on the screen at any distance; and groups that hold it. */
import { CanvasTexture, type Group, type Material, LineSegments, Mesh, SRGBColorSpace, Sprite, SpriteMaterial } from 'three';
import { context, sheet } from '../dom';
import type { Paint } from '../theme';

/** Height of the text at a distance of 1, which is a share of the height of the view; and at least so many pixels of it. */
const kText = 0.03;
const kPixels = 15;

export function label(words: string, paint: Paint, colour = paint.ink): Sprite {
  const canvas = sheet(1, 44);
  const font = '600 30px system-ui, "DejaVu Sans", sans-serif';
  const measure = context(canvas);
  measure.font = font;
  canvas.width = Math.ceil(measure.measureText(words).width) + 12;
  const pen = context(canvas);
  pen.font = font;
  pen.textBaseline = 'middle';
  pen.lineJoin = 'round';
  pen.lineWidth = 6;
  pen.strokeStyle = paint.halo;
  pen.strokeText(words, 6, 23);
  pen.fillStyle = colour;
  pen.fillText(words, 6, 23);
  const map = new CanvasTexture(canvas);
  map.colorSpace = SRGBColorSpace;
  const sprite = new Sprite(new SpriteMaterial({ map, depthTest: false, transparent: true, sizeAttenuation: false }));
  sprite.scale.set((kText * canvas.width) / canvas.height, kText, 1);
  sprite.renderOrder = 5;
  return sprite;
}

/** Keeps the text of a group readable in a view of this height, px. */
export function fitText(group: Group, height: number): void {
  const size = Math.max(kText, kPixels / height);
  for (const { scale } of group.children.filter((child) => child instanceof Sprite)) {
    scale.multiplyScalar(size / scale.y);
  }
}

/** Empties a group of faces, lines and text. */
export function clear(group: Group): void {
  for (const child of group.children) {
    if (child instanceof Sprite) {
      child.material.map?.dispose();
      child.material.dispose();
    } else if (child instanceof LineSegments || child instanceof Mesh) {
      child.geometry.dispose();
      (child.material as Material).dispose();
    }
  }
  group.clear();
}
