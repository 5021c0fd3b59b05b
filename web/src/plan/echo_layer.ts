/**
 * Detected echoes at their positions, fading with age, and the samples at the pose where the sonar recorded them.
 *
 * A vertical fan measures range and depth of an object, but not its bearing within the beam width. Its echoes are
 * hollow, and its samples are a thin line along the middle of the wedge that it covers, so that they neither hide nor
 * resemble those of a horizontal fan.
 */
import { css, packed, rgbOf, tables } from '../colours';
import type { Model } from '../model';
import { PolarPicture } from '../polar';
import { SonarImage } from '../sonar_image';
import type { Paint } from '../theme';
import { verticalLine, type VerticalLine } from './vertical_line';
import type { Pen } from './pen';

const kFades = 4;
const kStops = 40;
/** px: width of the line that shows a vertical fan from above. */
const kLine = 4;
/** px: side of a hollow echo. */
const kFrame = 10;

export function drawTrail(pen: Pen, model: Model): void {
  const { drawing, camera, paint } = pen;
  const { trail } = model;
  const now = model.scene ? model.scene.start + model.now : model.newest;
  const size = Math.min(4, Math.max(2, 0.12 / camera.scale));
  drawing.lineWidth = 1;
  drawing.setLineDash([]);
  const framed = new Set<number>();
  for (let fade = 0; fade < kFades; ++fade) {
    drawing.fillStyle = css(paint.echo, 0.9 - 0.22 * fade);
    drawing.strokeStyle = drawing.fillStyle;
    for (let i = 0; i < trail.size; ++i) {
      const age = (now - trail.times[i]!) / trail.lasts[i]!;
      if (age < -0.05 || age >= 1 || Math.floor(Math.max(0, age) * kFades) !== fade) continue;
      const [north, east] = [trail.places[3 * i]!, trail.places[3 * i + 1]!];
      const [x, y] = [camera.x(north, east), camera.y(north, east)];
      if (trail.vertical[i] === 1) frame(drawing, x, y, framed);
      else drawing.fillRect(x - size / 2, y - size / 2, size, size);
    }
  }
}

/** A hollow square, unless there is one: surface and bottom echo all along the line of a vertical fan. */
function frame(drawing: CanvasRenderingContext2D, x: number, y: number, framed: Set<number>): void {
  const cell = Math.floor(x / kFrame) * 65536 + Math.floor(y / kFrame);
  if (framed.has(cell)) return;
  framed.add(cell);
  drawing.strokeRect(x - kFrame / 2, y - kFrame / 2, kFrame, kFrame);
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

interface Seen {
  image: SonarImage;
  paint: Paint;
  revision: number;
  line: VerticalLine | null;
  fill: CanvasGradient | null;
}

/**
 * A fan is one picture at the pose of its ping. The beams of a scanning head have a pose each, so each is drawn as its
 * own wedge, with its samples along the radius. The motion of the vehicle therefore does not smear static objects.
 */
export class SampleLayer {
  private readonly laid = new Map<number, Laid>();
  private readonly lines = new Map<number, Seen>();
  private readonly along = new Float64Array(3);

  draw(pen: Pen, model: Model): void {
    for (const vertical of [false, true]) {
      for (const [number, image] of model.sonars) {
        if (image.sonar.vertical !== vertical || image.newest < 0) continue;
        if (vertical) this.line(pen, number, image);
        else this.lay(pen, number, image);
      }
    }
  }

  private lay(pen: Pen, number: number, image: SonarImage): void {
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

  private line(pen: Pen, number: number, image: SonarImage): void {
    let seen = this.lines.get(number);
    if (!seen || seen.image !== image || seen.paint !== pen.paint || seen.revision !== image.revision) {
      const line = verticalLine(image);
      const fill = line && stretches(pen, line);
      seen = { image, paint: pen.paint, revision: image.revision, line, fill };
      this.lines.set(number, seen);
    }
    const { line, fill } = seen;
    if (!line || !fill) return;
    const { drawing, camera, paint } = pen;
    drawing.save();
    drawing.translate(camera.x(line.north, line.east), camera.y(line.north, line.east));
    drawing.rotate(line.heading - camera.turn);
    drawing.scale(1 / camera.scale, 1 / camera.scale); // m from here on, the line leads up
    const pixel = camera.scale;
    drawing.beginPath();
    for (const reach of [line.from, line.to]) {
      const [sin, cos] = [Math.sin(line.half) * reach, Math.cos(line.half) * reach];
      drawing.moveTo(0, 0);
      drawing.lineTo(-sin, -cos);
      drawing.moveTo(0, 0);
      drawing.lineTo(sin, -cos);
    }
    drawing.lineWidth = pixel;
    drawing.setLineDash([7 * pixel, 5 * pixel]);
    drawing.strokeStyle = paint.ink;
    drawing.stroke();
    drawing.setLineDash([]);
    drawing.fillStyle = paint.halo;
    const width = kLine * pixel;
    drawing.fillRect(-width / 2 - pixel, -line.to, width + 2 * pixel, line.to - line.from);
    drawing.fillStyle = fill;
    drawing.fillRect(-width / 2, -line.to, width, line.to - line.from);
    drawing.restore();
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

  /** East and north components of the boresight. */
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

/** Weak samples are transparent. */
function seeThrough(paint: Paint): Uint32Array {
  const table = tables[paint.intensity];
  return table.map((word, i) => packed(rgbOf(word), Math.round(40 + 200 * Math.min(1, i / 120))));
}

/** Shows the strongest sample of each stretch of bins, so that a thin echo does not fall between two stops. */
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

/** The samples of a vertical fan from (0, 0) upwards: each stretch in the colour of its level, without blending. */
function stretches({ drawing, paint }: Pen, { from, to, levels }: VerticalLine): CanvasGradient {
  const table = tables[paint.intensity];
  const fill = drawing.createLinearGradient(0, -from, 0, -to);
  const count = levels.length;
  for (let cell = 0; cell < count; ++cell) {
    const level = levels[cell]!;
    const colour = css(rgbOf(table[Math.max(0, level)]!), level < 0 ? 0 : 1);
    fill.addColorStop(cell / count, colour);
    fill.addColorStop((cell + 1) / count, colour);
  }
  return fill;
}
