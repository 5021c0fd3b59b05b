/** StripView: the samples unrolled, beams side by side from port to starboard, range upwards, without resampling. */
import { context, sheet } from '../dom';
import { kFont } from '../plan/pen';
import type { SonarImage } from '../sonar_image';
import type { Paint } from '../theme';
import { roundStep } from '../units';
import { directionText, type Form, type Sample, type Sheet } from './sample';

const kLeft = 46;
const kRight = 12;
const kTop = 24;
const kBottom = 36;

export class StripView implements Form {
  private readonly canvas = sheet(1, 1);
  private pixels: ImageData | null = null;
  private order = new Int32Array(0);
  private owner: SonarImage | null = null;
  private painted = '';
  private box = { width: 1, height: 1 };

  draw({ drawing, width, height, image, paint, table, decided, look }: Sheet): void {
    if (this.owner !== image) this.adopt(image);
    if (this.painted !== look) {
      this.paint(image, table, decided);
      this.painted = look;
    }
    this.box = { width: Math.max(1, width - kLeft - kRight), height: Math.max(1, height - kTop - kBottom) };
    drawing.imageSmoothingEnabled = false;
    drawing.drawImage(this.canvas, kLeft, kTop, this.box.width, this.box.height);
    drawing.strokeStyle = paint.faint;
    drawing.lineWidth = 1;
    drawing.strokeRect(kLeft - 0.5, kTop - 0.5, this.box.width + 1, this.box.height + 1);
    this.numbers(drawing, image, paint);
  }

  sampleAt(px: number, py: number, image: SonarImage): Sample | null {
    const column = Math.floor(((px - kLeft) / this.box.width) * image.beams);
    const bin = image.bins - 1 - Math.floor(((py - kTop) / this.box.height) * image.bins);
    const beam = this.order[column];
    return beam === undefined || bin < 0 || bin >= image.bins ? null : { beam, bin };
  }

  point(drawing: CanvasRenderingContext2D, image: SonarImage, { beam, bin }: Sample, colour: string): void {
    const column = this.order.indexOf(beam);
    const x = kLeft + ((column + 0.5) / image.beams) * this.box.width;
    drawing.strokeStyle = colour;
    drawing.lineWidth = 1;
    drawing.setLineDash([3, 3]);
    drawing.beginPath();
    drawing.moveTo(x, kTop);
    drawing.lineTo(x, kTop + this.box.height);
    drawing.stroke();
    drawing.setLineDash([]);
    if (bin < 0) return;
    drawing.lineWidth = 2;
    drawing.beginPath();
    drawing.arc(x, kTop + (1 - (bin + 0.5) / image.bins) * this.box.height, 6, 0, 2 * Math.PI);
    drawing.stroke();
  }

  private adopt(image: SonarImage): void {
    this.owner = image;
    this.painted = '';
    this.canvas.width = image.beams;
    this.canvas.height = image.bins;
    this.pixels = new ImageData(image.beams, image.bins);
    const { azimuth } = image.sonar;
    this.order = Int32Array.from(azimuth.keys()).sort((a, b) => azimuth[a]! - azimuth[b]!);
  }

  private paint(image: SonarImage, table: Uint32Array, decided: number): void {
    const { beams, bins, intensity } = image;
    const out = new Uint32Array(this.pixels!.data.buffer);
    for (let column = 0; column < beams; ++column) {
      const beam = this.order[column]!;
      const heard = !Number.isNaN(image.heard[beam]!);
      const from = beam * bins;
      for (let bin = 0; bin < bins; ++bin) {
        const i = from + bin;
        const to = (bins - 1 - bin) * beams + column;
        out[to] = !heard ? 0 : decided !== 0 && image.decided[i] === 1 ? decided : table[intensity[i]!]!;
      }
    }
    context(this.canvas).putImageData(this.pixels!, 0, 0);
  }

  private numbers(drawing: CanvasRenderingContext2D, image: SonarImage, paint: Paint): void {
    drawing.font = kFont;
    drawing.fillStyle = paint.ink;
    drawing.textBaseline = 'middle';
    drawing.textAlign = 'right';
    const { first } = image.sonar;
    const step = roundStep((image.reach - first) / Math.max(2, this.box.height / 45));
    for (let range = Math.ceil(first / step) * step; range <= image.reach; range += step) {
      const y = kTop + (1 - (range - first) / (image.reach - first)) * this.box.height;
      drawing.fillText(`${Math.round(range * 100) / 100} m`, kLeft - 6, y);
      drawing.fillRect(kLeft - 4, y - 0.5, 4, 1);
    }
    drawing.textAlign = 'center';
    const every = Math.max(1, Math.floor(image.beams / Math.max(2, this.box.width / 70)));
    for (let column = Math.floor(every / 2); column < image.beams; column += every) {
      const x = kLeft + ((column + 0.5) / image.beams) * this.box.width;
      drawing.fillText(directionText(image, image.sonar.azimuth[this.order[column]!]!), x, kTop + this.box.height + 11);
    }
    drawing.fillStyle = paint.faint;
    drawing.fillText(
      image.sonar.vertical ? 'elevation of the beam above the horizon' : 'azimuth of the beam: port − , starboard +',
      kLeft + this.box.width / 2,
      kTop + this.box.height + 26,
    );
  }
}
