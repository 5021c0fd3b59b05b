/**
 * GridLayer: the occupancy grid around the vehicle. Free cells are a light veil, occupied cells are solid, unknown
 * cells are not drawn.
 */
import { packed } from '../colours';
import { context, sheet } from '../dom';
import type { Grid } from '../protocol';
import type { Paint } from '../theme';
import { place, type Pen } from './pen';

export class GridLayer {
  private readonly image = sheet(1, 1);
  private drawn: Grid | null = null;
  private painted: Paint | null = null;

  draw(pen: Pen, grid: Grid): void {
    if (this.drawn !== grid || this.painted !== pen.paint) this.paint(grid, pen.paint);
    pen.drawing.imageSmoothingEnabled = false;
    place(pen, this.image, [grid.north, grid.east], grid.heading, [grid.nx * grid.cell, grid.ny * grid.cell]);
    pen.drawing.imageSmoothingEnabled = true;
  }

  private paint(grid: Grid, paint: Paint): void {
    const { nx, ny, cells } = grid;
    this.drawn = grid;
    this.painted = paint;
    this.image.width = Math.max(1, ny);
    this.image.height = Math.max(1, nx);
    if (nx * ny === 0) return;
    const colours = occupancy(paint, grid.threshold);
    const pixels = new ImageData(ny, nx);
    const out = new Uint32Array(pixels.data.buffer);
    for (let x = 0; x < nx; ++x) {
      for (let y = 0; y < ny; ++y) out[(nx - 1 - x) * ny + y] = colours[cells[x * ny + y]!]!;
    }
    context(this.image).putImageData(pixels, 0, 0);
  }
}

/** Colours by the byte of a cell: visible from half the threshold on, solid from the threshold on. */
function occupancy(paint: Paint, threshold: number): Uint32Array {
  const limit = threshold > 0 && threshold < 1 ? threshold : 0.5;
  return Uint32Array.from({ length: 256 }, (_, byte) => {
    if (byte > 250) return 0;
    const p = byte / 250;
    if (p >= limit) return packed(paint.occupied, Math.round(150 + 80 * ((p - limit) / (1 - limit))));
    const share = p / limit;
    if (share > 0.5) return packed(paint.occupied, Math.round(110 * (share - 0.5)));
    return packed(paint.free, Math.round(200 * (0.5 - share)));
  });
}
