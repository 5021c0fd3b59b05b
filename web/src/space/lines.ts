/** Thread: a growing line through positions in W; its buffer is reallocated seldom. */
import { BufferAttribute, BufferGeometry, Line, LineBasicMaterial } from 'three';
import { put } from './frame';

export class Thread {
  readonly line: Line<BufferGeometry, LineBasicMaterial>;
  private places = new Float32Array(0);

  constructor() {
    this.line = new Line(new BufferGeometry(), new LineBasicMaterial());
    this.line.frustumCulled = false;
  }

  show(count: number, place: (i: number) => readonly [number, number, number], stretch: number, colour: string): void {
    this.line.material.color.set(colour);
    this.line.visible = count > 1;
    if (3 * count > this.places.length) {
      this.places = new Float32Array(3 * Math.ceil(1.5 * count));
      this.line.geometry.dispose();
      this.line.geometry = new BufferGeometry();
      this.line.geometry.setAttribute('position', new BufferAttribute(this.places, 3));
    }
    for (let i = 0; i < count; ++i) {
      const [north, east, down] = place(i);
      put(this.places, i, north, east, down * stretch);
    }
    this.line.geometry.setDrawRange(0, count);
    const attribute = this.line.geometry.getAttribute('position');
    if (attribute) attribute.needsUpdate = true;
  }
}
