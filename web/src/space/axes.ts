/** Axes: a grid below the scene and numbers along north, east and depth. */
import { BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineSegments } from 'three';
import type { Paint } from '../theme';
import { roundStep } from '../units';
import { at, type Extent } from './frame';
import { clear, label } from './labels';

export class Axes {
  readonly group = new Group();
  private look = '';

  /** Builds the axes again if the extent (m), the vertical stretch or the colours have changed. */
  build(extent: Extent, stretch: number, paint: Paint): void {
    const level = roundStep(Math.max(extent.high[0]! - extent.low[0]!, extent.high[1]! - extent.low[1]!) / 5);
    // Not so close that the numbers would overlap.
    const deep = roundStep(Math.max(Math.max(1, extent.high[2]!) / 3, (0.35 * level) / stretch));
    const low = [0, 1].map((k) => Math.floor(extent.low[k]! / level) * level) as [number, number];
    const high = [0, 1].map((k) => Math.ceil(extent.high[k]! / level) * level) as [number, number];
    const floor = Math.ceil(Math.max(1, extent.high[2]!) / deep) * deep;
    const look = [low, high, floor, level, deep, stretch, paint.ink].join();
    if (look === this.look) return;
    this.look = look;
    clear(this.group);
    const lines: number[] = [];
    const line = (...ends: [number, number, number][]) => {
      for (const [n, e, d] of ends) lines.push(...at(n, e, d * stretch).toArray());
    };
    const size = 0.042 * Math.max(high[0] - low[0], high[1] - low[1]);
    const text = (words: string, n: number, e: number, d: number) => {
      const sprite = label(words, paint);
      sprite.position.copy(at(n, e, d * stretch));
      this.group.add(sprite);
    };
    const count = (v: number) => String(Math.round(v * 100) / 100).replace('-', '−');
    for (let n = low[0]; n <= high[0] + 1e-6; n += level) {
      line([n, low[1], floor], [n, high[1], floor]);
      text(count(n), n, low[1] - 1.1 * size, floor);
    }
    for (let e = low[1]; e <= high[1] + 1e-6; e += level) {
      line([low[0], e, floor], [high[0], e, floor]);
      text(count(e), low[0] - 1.1 * size, e, floor);
    }
    for (const [n, e] of [low, [high[0], low[1]], [low[0], high[1]]] as [number, number][])
      line([n, e, 0], [n, e, floor]);
    for (let d = 0; d <= floor + 1e-6; d += deep) {
      line([high[0], low[1], d], [high[0] + size / 2, low[1] - size / 2, d]);
      text(d === 0 ? '0 m' : `${count(d)}`, high[0] + 0.8 * size, low[1] - 0.8 * size, d);
    }
    text('North, m', (low[0] + high[0]) / 2 + level / 2, low[1] - 3.4 * size, floor);
    text('East, m', low[0] - 2.6 * size, (low[1] + high[1]) / 2 + level / 2, floor);
    text(`Down, m${stretch > 1 ? `  (× ${stretch})` : ''}`, high[0] + 2 * size, low[1] - 2 * size, floor / 2);
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(Float32Array.from(lines), 3));
    this.group.add(
      new LineSegments(geometry, new LineBasicMaterial({ color: paint.faint, transparent: true, opacity: 0.55 })),
    );
  }
}
