/**
 * PolarPicture: the samples of a sonar as a picture. The sample of each pixel is computed once; then a ping takes one
 * table look-up per pixel.
 */
import { context, sheet } from './dom';
import type { Sonar } from './items';
import type { SonarImage } from './sonar_image';

const kDirections = 4096;

/** The nearest beam of each of kDirections directions, from -pi on; -1: none looks there. */
export function beamsByDirection(sonar: Sonar): Int16Array {
  const out = new Int16Array(kDirections).fill(-1);
  const order = Array.from(sonar.azimuth.keys()).sort((a, b) => sonar.azimuth[a]! - sonar.azimuth[b]!);
  const step = (2 * Math.PI) / kDirections;
  const off = new Float32Array(kDirections).fill(Infinity);
  for (const [place, beam] of order.entries()) {
    const azimuth = sonar.azimuth[beam]!;
    const beside = [order[place - 1], order[place + 1]].map((other) =>
      other === undefined ? 0 : Math.abs(sonar.azimuth[other]! - azimuth),
    );
    // A gap of more than a few widths is a gap, not a beam.
    const gap = Math.min(Math.max(...beside), 3 * Math.max(sonar.width[beam]!, step));
    const half = Math.max(sonar.width[beam]! / 2, gap / 2, step);
    const [from, to] = [Math.floor((azimuth - half + Math.PI) / step), Math.ceil((azimuth + half + Math.PI) / step)];
    for (let i = from; i <= to; ++i) {
      const away = Math.abs((i + 0.5) * step - Math.PI - azimuth);
      const at = ((i % kDirections) + kDirections) % kDirections;
      if (away > half + step || away >= off[at]!) continue;
      off[at] = away;
      out[at] = beam;
    }
  }
  return out;
}

/** Bounds of a fan or a turn, m; the sensor is at (0, 0) and looks up. */
export interface Box {
  left: number;
  right: number;
  up: number;
  down: number;
}

export function boxOf(image: SonarImage): Box {
  const box = { left: 0, right: 0, up: 0, down: 0 };
  const { azimuth } = image.sonar;
  for (let i = 0; i < azimuth.length; ++i) {
    const [x, y] = [Math.sin(azimuth[i]!) * image.reach, Math.cos(azimuth[i]!) * image.reach];
    box.left = Math.min(box.left, x);
    box.right = Math.max(box.right, x);
    box.up = Math.max(box.up, y);
    box.down = Math.min(box.down, y);
  }
  return box;
}

export class PolarPicture {
  readonly canvas = sheet(1, 1);
  readonly box: Box;
  private readonly sample: Int32Array;
  private readonly pixels: ImageData;
  private readonly out: Uint32Array;

  constructor(
    private readonly image: SonarImage,
    /** m a pixel */
    readonly scale: number,
  ) {
    this.box = boxOf(image);
    const { left, right, up, down } = this.box;
    const width = Math.max(1, Math.ceil((right - left) / scale));
    const height = Math.max(1, Math.ceil((up - down) / scale));
    this.canvas.width = width;
    this.canvas.height = height;
    this.pixels = new ImageData(width, height);
    this.out = new Uint32Array(this.pixels.data.buffer);
    this.sample = new Int32Array(width * height).fill(-1);
    const beams = beamsByDirection(image.sonar);
    const { bins } = image;
    const { first, bin } = image.sonar;
    for (let row = 0; row < height; ++row) {
      const y = up - (row + 0.5) * scale;
      for (let column = 0; column < width; ++column) {
        const x = left + (column + 0.5) * scale;
        const at = Math.floor((Math.hypot(x, y) - first) / bin);
        if (at < 0 || at >= bins) continue;
        const direction = Math.floor(((Math.atan2(x, y) + Math.PI) / (2 * Math.PI)) * kDirections) % kDirections;
        const beam = beams[direction]!;
        if (beam >= 0) this.sample[row * width + column] = beam * bins + at;
      }
    }
  }

  /** `decided`: colour of samples detected as echo; 0: the colour of their level. */
  paint(table: Uint32Array, decided: number): void {
    const { intensity, decided: echoes, heard, bins } = this.image;
    const { out, sample } = this;
    for (let i = 0; i < sample.length; ++i) {
      const at = sample[i]!;
      if (at < 0) continue;
      if (decided !== 0 && echoes[at] === 1) out[i] = decided;
      else out[i] = Number.isNaN(heard[(at / bins) | 0]!) ? 0 : table[intensity[at]!]!;
    }
    context(this.canvas).putImageData(this.pixels, 0, 0);
  }
}
