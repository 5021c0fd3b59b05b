/** What the two forms of the sonar's picture share. */
import type { SonarImage } from '../sonar_image';
import type { Paint } from '../theme';
import { elevation } from '../units';

/** One sample of a sonar; bin -1: the whole beam. */
export interface Sample {
  beam: number;
  bin: number;
}

export interface Sheet {
  drawing: CanvasRenderingContext2D;
  width: number;
  height: number;
  image: SonarImage;
  paint: Paint;
  /** Colours of the levels. */
  table: Uint32Array;
  /** Of samples that were decided as echo; 0: as any other. */
  decided: number;
  /** Changes whenever the samples have to be painted again. */
  look: string;
}

export interface Form {
  draw(sheet: Sheet): void;
  /** Under a place of the canvas. */
  sampleAt(x: number, y: number, image: SonarImage): Sample | null;
  /** A ring at a sample, and its beam. */
  point(drawing: CanvasRenderingContext2D, image: SonarImage, sample: Sample, colour: string): void;
}

/** Of a direction in the plane of the fan: its azimuth, or how far it looks up or down where the fan stands upright. */
export function directionText(image: SonarImage, azimuth: number): string {
  if (image.sonar.upright) return elevation(image.elevation(azimuth));
  return `${Math.round((azimuth * 180) / Math.PI)}°`.replace('-', '−');
}
