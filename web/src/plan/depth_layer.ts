/**
 * DepthLayer: the tiles of the depth map. The image of a tile is remade only if the tile, the depth scale or the theme
 * has changed. Higher confidence is more opaque; charted depths that were never measured are hatched.
 */
import { rgbOf, packed } from '../colours';
import { context, pixelRatio, sheet } from '../dom';
import type { Model } from '../model';
import { DepthFlag, type DepthTile } from '../protocol';
import type { Theme } from '../theme';
import type { Camera } from './camera';
import { place, type Pen } from './pen';

export type DepthShows = 'depth' | 'confidence';

interface Image {
  revision: number;
  look: string;
  colours: HTMLCanvasElement;
  /** Opaque where hatched; null: no hatching. */
  unproven: HTMLCanvasElement | null;
}

const kScales = [1, 2, 3, 5, 8, 10, 15, 20, 30, 50, 80, 100, 150, 200, 300, 500, 1000, 2000, 5000, 11000];

export class DepthLayer {
  shows: DepthShows = 'depth';
  /** Depth of the darkest colour, m. */
  deepest = 1;
  private readonly images = new Map<string, Image>();
  private readonly deepestOf = new Map<string, { revision: number; depth: number }>();
  private readonly veil = sheet(1, 1);
  private seen = -1;
  private hatch: CanvasPattern | null = null;
  private hatchLook = '';

  constructor(
    private readonly model: Model,
    private readonly theme: Theme,
  ) {}

  /** Whether there is any tile. */
  get any(): boolean {
    return this.model.depth.size > 0;
  }

  /** Opposite corners of the tiles. */
  get corners(): [number, number][] {
    return [...this.model.depth.values()].flatMap(({ item: { north, east, side, pixel } }): [number, number][] => [
      [north, east],
      [north + side * pixel, east + side * pixel],
    ]);
  }

  draw(pen: Pen, revision: number): void {
    if (revision !== this.seen) this.measure(revision);
    const look = `${this.shows} ${this.deepest} ${this.theme.name}`;
    const { camera, drawing } = pen;
    const visible: [DepthTile, Image][] = [];
    for (const [key, { item, revision: changed }] of this.model.depth) {
      if (!near(camera, item)) continue;
      let image = this.images.get(key);
      if (!image || image.revision !== changed || image.look !== look) {
        image = this.paint(item, changed, look);
        this.images.set(key, image);
      }
      visible.push([item, image]);
    }
    drawing.imageSmoothingEnabled = visible.length > 0 && visible[0]![0].pixel / camera.scale < 3;
    for (const [tile, image] of visible) set(pen, tile, image.colours);
    if (visible.some(([, image]) => image.unproven)) this.hatchOver(pen, visible);
    drawing.imageSmoothingEnabled = true;
  }

  /** Chooses a round end of the scale, so that the scale, and with it all images, change seldom. */
  private measure(revision: number): void {
    this.seen = revision;
    let deepest = 0;
    for (const [key, { item, revision: changed }] of this.model.depth) {
      let known = this.deepestOf.get(key);
      if (known?.revision !== changed) {
        known = { revision: changed, depth: item.depth.reduce((most, d) => (d > most ? d : most), 0) };
        this.deepestOf.set(key, known);
      }
      deepest = Math.max(deepest, known.depth);
    }
    for (const key of this.images.keys()) {
      if (this.model.depth.has(key)) continue;
      this.images.delete(key);
      this.deepestOf.delete(key);
    }
    this.deepest = kScales.find((scale) => scale >= deepest) ?? deepest;
  }

  private paint(tile: DepthTile, revision: number, look: string): Image {
    const { side, depth, confidence, flags } = tile;
    const paint = this.theme.paint;
    const colours = sheet(side, side);
    const pixels = new ImageData(side, side);
    const out = new Uint32Array(pixels.data.buffer);
    const veil = new ImageData(side, side);
    const veiled = new Uint32Array(veil.data.buffer);
    let unproven = false;
    for (let row = 0; row < side; ++row) {
      for (let column = 0; column < side; ++column) {
        const i = row * side + column;
        const to = (side - 1 - row) * side + column;
        const d = depth[i]!;
        const bits = flags[i]!;
        if ((bits & DepthFlag.obstacle) !== 0) {
          out[to] = packed(paint.occupied, 190);
        } else if (!Number.isNaN(d)) {
          const sure = Math.min(1, confidence[i]! / 20);
          if (this.shows === 'confidence') {
            out[to] = packed(paint.confidence[Math.min(4, Math.floor(confidence[i]! / 5))]!, 235);
          } else {
            const colour = rgbOf(paint.depth[Math.min(255, Math.max(0, Math.round((255 * d) / this.deepest)))]!);
            out[to] = packed(colour, Math.round(255 * (0.35 + 0.65 * Math.sqrt(sure))));
            if ((bits & DepthFlag.measured) === 0) {
              veiled[to] = 0xff000000;
              unproven = true;
            }
          }
        }
      }
    }
    context(colours).putImageData(pixels, 0, 0);
    if (!unproven) return { revision, look, colours, unproven: null };
    const mask = sheet(side, side);
    context(mask).putImageData(veil, 0, 0);
    return { revision, look, colours, unproven: mask };
  }

  /** Hatching is drawn in screen scale: first all masks, then lines within them. */
  private hatchOver(pen: Pen, visible: readonly [DepthTile, Image][]): void {
    const { camera, drawing } = pen;
    const ratio = pixelRatio();
    const [width, height] = [Math.round(camera.width * ratio), Math.round(camera.height * ratio)];
    if (this.veil.width !== width || this.veil.height !== height) {
      this.veil.width = width;
      this.veil.height = height;
    }
    const veil = context(this.veil);
    veil.setTransform(ratio, 0, 0, ratio, 0, 0);
    veil.globalCompositeOperation = 'source-over';
    veil.clearRect(0, 0, camera.width, camera.height);
    veil.imageSmoothingEnabled = false;
    for (const [tile, image] of visible) if (image.unproven) set({ ...pen, drawing: veil }, tile, image.unproven);
    veil.globalCompositeOperation = 'source-in';
    veil.fillStyle = this.hatching(veil);
    veil.fillRect(0, 0, camera.width, camera.height);
    drawing.drawImage(this.veil, 0, 0, camera.width, camera.height);
  }

  private hatching(drawing: CanvasRenderingContext2D): CanvasPattern | string {
    if (this.hatch && this.hatchLook === this.theme.name) return this.hatch;
    const cell = sheet(8, 8);
    const pen = context(cell);
    pen.strokeStyle = this.theme.paint.hatch;
    pen.lineWidth = 1.2;
    for (const from of [-8, 0, 8]) {
      pen.moveTo(from - 1, 9);
      pen.lineTo(from + 9, -1);
    }
    pen.stroke();
    this.hatch = drawing.createPattern(cell, 'repeat');
    this.hatchLook = this.theme.name;
    return this.hatch ?? 'transparent';
  }
}

function near(camera: Camera, tile: DepthTile): boolean {
  const half = (tile.side * tile.pixel) / 2;
  return Math.hypot(tile.north + half - camera.north, tile.east + half - camera.east) < camera.reach + half * 1.42;
}

function set(pen: Pen, tile: DepthTile, image: HTMLCanvasElement): void {
  const { camera, drawing } = pen;
  const size = tile.side * tile.pixel;
  if (camera.turn !== 0) return place(pen, image, [tile.north, tile.east], 0, [size, size]);
  // Rounded to whole screen pixels, so that no seam shows between neighbours.
  const ratio = pixelRatio();
  const whole = (v: number) => Math.round(v * ratio) / ratio;
  const [left, right] = [camera.x(0, tile.east), camera.x(0, tile.east + size)].map(whole) as [number, number];
  const [top, bottom] = [camera.y(tile.north + size, 0), camera.y(tile.north, 0)].map(whole) as [number, number];
  drawing.drawImage(image, left, top, right - left, bottom - top);
}
