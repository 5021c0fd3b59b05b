/** Decided echoes where they are, fading with age; and the samples themselves, laid where the sonar heard them. */
import { css, packed, rgbOf, tables } from '../colours';
import type { Model } from '../model';
import { PolarPicture } from '../polar';
import { SonarImage } from '../sonar_image';
import type { Paint } from '../theme';
import type { Pen } from './pen';

const kFades = 4;
const kStops = 40;

export function drawTrail(pen: Pen, model: Model): void {
  const { drawing, camera, paint } = pen;
  const { trail } = model;
  const now = model.scene ? model.scene.start + model.now : model.newest;
  const size = Math.min(4, Math.max(2, 0.12 / camera.scale));
  for (let fade = 0; fade < kFades; ++fade) {
    drawing.fillStyle = css(paint.echo, 0.9 - 0.22 * fade);
    for (let i = 0; i < trail.size; ++i) {
      const age = (now - trail.times[i]!) / trail.lasts[i]!;
      if (age < -0.05 || age >= 1 || Math.floor(Math.max(0, age) * kFades) !== fade) continue;
      const [north, east] = [trail.places[3 * i]!, trail.places[3 * i + 1]!];
      drawing.fillRect(camera.x(north, east) - size / 2, camera.y(north, east) - size / 2, size, size);
    }
  }
}

interface Wedge {
  revision: number;
  fill: CanvasGradient;
}
interface Laid {
  image: SonarImage;
  paint: Paint;
  revision: number;
  picture: PolarPicture | null;
  wedges: (Wedge | undefined)[];
}

/**
 * A fan is one picture at the pose of its ping. The beams of a scanning head were heard from many poses: each is a wedge
 * of its own with its samples along the radius, so that a turning vehicle does not smear what stands still.
 */
export class SampleLayer {
  private readonly laid = new Map<number, Laid>();
  private readonly along = new Float64Array(3);

  draw(pen: Pen, model: Model): void {
    for (const [number, image] of model.sonars) {
      if (image.sonar.upright || image.newest < 0) continue;
      let laid = this.laid.get(number);
      if (!laid || laid.image !== image || laid.paint !== pen.paint) {
        const picture = image.sonar.scanning
          ? null
          : new PolarPicture(image, Math.max(image.sonar.bin, image.reach / 300));
        laid = { image, paint: pen.paint, revision: -1, picture, wedges: [] };
        this.laid.set(number, laid);
      }
      if (laid.picture) this.fan(pen, laid, laid.picture);
      else this.turn(pen, laid);
    }
  }

  private fan({ drawing, camera, paint }: Pen, laid: Laid, picture: PolarPicture): void {
    const { image } = laid;
    if (laid.revision !== image.revision) {
      picture.paint(seeThrough(paint), 0);
      laid.revision = image.revision;
    }
    const at = image.newest * 7;
    const { left, up } = picture.box;
    drawing.save();
    this.stand(drawing, camera, image, image.newest);
    drawing.rotate(Math.atan2(...this.boresight(image, at)) - camera.turn);
    if (hangsUpsideDown(image, at)) drawing.scale(-1, 1);
    const scale = 1 / camera.scale;
    const { width, height } = picture.canvas;
    drawing.drawImage(
      picture.canvas,
      left * scale,
      -up * scale,
      width * picture.scale * scale,
      height * picture.scale * scale,
    );
    drawing.restore();
  }

  /** East and north of the direction in which the sensor looks. */
  private boresight(image: SonarImage, at: number): [number, number] {
    const [w, i, j, k] = image.poses.subarray(at + 3, at + 7) as unknown as [number, number, number, number];
    return [2 * (i * j + w * k), 1 - 2 * (j * j + k * k)];
  }

  private turn({ drawing, camera, paint }: Pen, laid: Laid): void {
    const { image } = laid;
    const scale = 1 / camera.scale;
    for (let beam = 0; beam < image.beams; ++beam) {
      if (Number.isNaN(image.heard[beam]!)) continue;
      let wedge = laid.wedges[beam];
      if (!wedge || wedge.revision !== image.revisions[beam]) {
        wedge = { revision: image.revisions[beam]!, fill: radial(drawing, image, beam, paint) };
        laid.wedges[beam] = wedge;
      }
      image.direction(beam, this.along);
      const heading = Math.atan2(this.along[1]!, this.along[0]!) - camera.turn;
      const half = image.sonar.width[beam]! * 0.55;
      drawing.save();
      this.stand(drawing, camera, image, beam);
      drawing.rotate(heading);
      drawing.scale(scale, scale);
      drawing.beginPath();
      const [sin, cos] = [Math.sin(half) * image.reach, Math.cos(half) * image.reach];
      drawing.moveTo(0, 0);
      drawing.lineTo(-sin, -cos);
      drawing.lineTo(sin, -cos);
      drawing.fillStyle = wedge.fill;
      drawing.fill();
      drawing.restore();
    }
  }

  private stand(drawing: CanvasRenderingContext2D, camera: Pen['camera'], image: SonarImage, beam: number): void {
    const [north, east] = [image.poses[beam * 7]!, image.poses[beam * 7 + 1]!];
    drawing.translate(camera.x(north, east), camera.y(north, east));
  }
}

function hangsUpsideDown(image: SonarImage, at: number): boolean {
  return image.poses[at + 4]! ** 2 + image.poses[at + 5]! ** 2 > 0.5;
}

/** What is weak lets the map through. */
function seeThrough(paint: Paint): Uint32Array {
  const table = tables[paint.intensity];
  return table.map((word, i) => packed(rgbOf(word), Math.round(40 + 200 * Math.min(1, i / 120))));
}

/** The strongest of each stretch of bins: a thin echo must not fall between two stops. */
function radial(drawing: CanvasRenderingContext2D, image: SonarImage, beam: number, paint: Paint): CanvasGradient {
  const { bins, intensity, sonar, reach } = image;
  const table = tables[paint.intensity];
  const fill = drawing.createRadialGradient(0, 0, 0, 0, 0, reach);
  const step = Math.max(1, Math.ceil(bins / kStops));
  for (let from = 0; from < bins; from += step) {
    let most = 0;
    for (let bin = from; bin < Math.min(bins, from + step); ++bin) most = Math.max(most, intensity[beam * bins + bin]!);
    const alpha = (40 + 200 * Math.min(1, most / 120)) / 255;
    const at = (sonar.first + Math.min(bins, from + step / 2) * sonar.bin) / reach;
    fill.addColorStop(Math.min(1, Math.max(0, at)), css(rgbOf(table[most]!), alpha));
  }
  return fill;
}
