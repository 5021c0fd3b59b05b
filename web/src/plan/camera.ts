/** Camera: the section of the plan view: the position at its centre, metres per CSS pixel, and the direction up. */
export class Camera {
  north = 0;
  east = 0;
  scale = 0.25;
  /** rad, clockwise from north. */
  turn = 0;
  width = 1;
  height = 1;
  private c = 1;
  private s = 0;

  static readonly finest = 0.004;
  static readonly coarsest = 200;

  settle(): void {
    this.c = Math.cos(this.turn);
    this.s = Math.sin(this.turn);
  }
  x(north: number, east: number): number {
    return this.width / 2 + ((east - this.east) * this.c - (north - this.north) * this.s) / this.scale;
  }
  y(north: number, east: number): number {
    return this.height / 2 - ((north - this.north) * this.c + (east - this.east) * this.s) / this.scale;
  }
  place(x: number, y: number): [number, number] {
    const right = (x - this.width / 2) * this.scale;
    const up = (this.height / 2 - y) * this.scale;
    return [this.north + up * this.c - right * this.s, this.east + up * this.s + right * this.c];
  }
  pan(dx: number, dy: number): void {
    const [north, east] = this.place(this.width / 2 - dx, this.height / 2 - dy);
    this.north = north;
    this.east = east;
  }
  /** Zooms about (x, y), which keeps its position. */
  zoom(factor: number, x = this.width / 2, y = this.height / 2): void {
    const [north, east] = this.place(x, y);
    this.scale = Math.min(Camera.coarsest, Math.max(Camera.finest, this.scale / factor));
    const [movedNorth, movedEast] = this.place(x, y);
    this.north += north - movedNorth;
    this.east += east - movedEast;
  }
  show(north: readonly [number, number], east: readonly [number, number], margin = 0.12): void {
    this.north = (north[0] + north[1]) / 2;
    this.east = (east[0] + east[1]) / 2;
    const free = 1 - 2 * margin;
    const high = Math.max(1, north[1] - north[0]);
    const wide = Math.max(1, east[1] - east[0]);
    this.scale = Math.min(
      Camera.coarsest,
      Math.max(Camera.finest, high / Math.max(50, this.height * free), wide / Math.max(50, this.width * free)),
    );
  }
  /** Half of the diagonal, m: no point farther than that from the centre is visible. */
  get reach(): number {
    return (Math.hypot(this.width, this.height) / 2) * this.scale;
  }
}
