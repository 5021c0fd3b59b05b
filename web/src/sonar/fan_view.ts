/** FanView: the samples of a fan or of a turn in true geometry; the sensor looks up. */
import { PolarPicture } from '../polar';
import type { SonarImage } from '../sonar_image';
import type { Paint } from '../theme';
import { roundStep } from '../units';
import { kFont } from '../plan/pen';
import { directionText, type Form, type Sample, type Sheet } from './sample';

export class FanView implements Form {
  private picture: PolarPicture | null = null;
  private painted = '';
  /** CSS pixels per metre, and the position of the sensor. */
  private scale = 1;
  private x = 0;
  private y = 0;

  draw({ drawing, width, height, image, paint, table, decided, look }: Sheet): void {
    const picture = this.of(image, width, height);
    if (this.painted !== look) {
      picture.paint(table, decided);
      this.painted = look;
    }
    const { left, right, up, down } = picture.box;
    const margin = 20;
    this.scale = Math.max(0.01, Math.min((width - 2 * margin) / (right - left), (height - 2 * margin) / (up - down)));
    this.x = width / 2 - ((left + right) / 2) * this.scale;
    this.y = height / 2 + ((up + down) / 2) * this.scale;
    drawing.imageSmoothingEnabled = true;
    drawing.drawImage(
      picture.canvas,
      this.x + left * this.scale,
      this.y - up * this.scale,
      picture.canvas.width * picture.scale * this.scale,
      picture.canvas.height * picture.scale * this.scale,
    );
    this.rings(drawing, image, paint);
  }

  sampleAt(px: number, py: number, image: SonarImage): Sample | null {
    const [right, ahead] = [(px - this.x) / this.scale, (this.y - py) / this.scale];
    const bin = Math.floor((Math.hypot(right, ahead) - image.sonar.first) / image.sonar.bin);
    if (bin < 0 || bin >= image.bins) return null;
    const azimuth = Math.atan2(right, ahead);
    let beam = -1;
    let nearest = Infinity;
    for (let i = 0; i < image.beams; ++i) {
      const off = Math.abs(
        Math.atan2(Math.sin(azimuth - image.sonar.azimuth[i]!), Math.cos(azimuth - image.sonar.azimuth[i]!)),
      );
      if (off < nearest) [nearest, beam] = [off, i];
    }
    return nearest < Math.max(0.03, image.sonar.width[beam] ?? 0) ? { beam, bin } : null;
  }

  point(drawing: CanvasRenderingContext2D, image: SonarImage, { beam, bin }: Sample, colour: string): void {
    const azimuth = image.sonar.azimuth[beam]!;
    const to = (range: number): [number, number] => [
      this.x + Math.sin(azimuth) * range * this.scale,
      this.y - Math.cos(azimuth) * range * this.scale,
    ];
    drawing.strokeStyle = colour;
    drawing.lineWidth = 1;
    drawing.setLineDash([3, 3]);
    drawing.beginPath();
    drawing.moveTo(...to(image.sonar.first));
    drawing.lineTo(...to(image.reach));
    drawing.stroke();
    drawing.setLineDash([]);
    if (bin < 0) return;
    drawing.lineWidth = 2;
    drawing.beginPath();
    drawing.arc(...to(image.rangeOf(bin)), 6, 0, 2 * Math.PI);
    drawing.stroke();
  }

  private of(image: SonarImage, width: number, height: number): PolarPicture {
    const most = Math.min(700, Math.max(200, Math.round(Math.max(width, height) / 100) * 100));
    const scale = Math.max(image.sonar.bin / 2, (2 * image.reach) / most);
    if (!this.picture || this.picture.scale !== scale || this.owner !== image) {
      this.picture = new PolarPicture(image, scale);
      this.owner = image;
      this.painted = '';
    }
    return this.picture;
  }
  private owner: SonarImage | null = null;

  private rings(drawing: CanvasRenderingContext2D, image: SonarImage, paint: Paint): void {
    const { azimuth } = image.sonar;
    const step = roundStep(image.reach / 5);
    const [from, to] = [Math.min(...azimuth), Math.max(...azimuth)];
    const whole = to - from > 1.9 * Math.PI;
    drawing.strokeStyle = paint.faint;
    drawing.globalAlpha = 0.55;
    drawing.lineWidth = 1;
    for (let range = step; range <= image.reach * 1.001; range += step) {
      drawing.beginPath();
      drawing.arc(
        this.x,
        this.y,
        range * this.scale,
        (whole ? 0 : from) - Math.PI / 2,
        (whole ? 2 * Math.PI : to) - Math.PI / 2,
      );
      drawing.stroke();
    }
    drawing.globalAlpha = 1;
    drawing.font = kFont;
    drawing.textBaseline = 'middle';
    const text = (words: string, x: number, y: number, align: CanvasTextAlign) => {
      drawing.textAlign = align;
      drawing.lineWidth = 3;
      drawing.strokeStyle = paint.halo;
      drawing.strokeText(words, x, y);
      drawing.fillStyle = paint.ink;
      drawing.fillText(words, x, y);
    };
    const along = whole ? 0 : to;
    for (let range = step; range <= image.reach * 1.001; range += step) {
      const [x, y] = [this.x + Math.sin(along) * range * this.scale, this.y - Math.cos(along) * range * this.scale];
      text(`${Math.round(range * 100) / 100} m`, x + (whole ? 4 : 8), y + (whole ? 0 : 6), 'left');
    }
    const spokes = whole ? [0, Math.PI / 2, Math.PI, -Math.PI / 2] : from < 0 && to > 0 ? [0, from, to] : [from, to];
    for (const azimuth of spokes) {
      const far = image.reach * this.scale + 13;
      const [x, y] = [this.x + Math.sin(azimuth) * far, this.y - Math.cos(azimuth) * far];
      text(directionText(image, azimuth), x, y, 'center');
    }
  }
}
