/** The parts that both forms of the sonar's picture share. */
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
  /** Colour of samples detected as echo; 0: the colour of their level. */
  decided: number;
  /** Changes whenever the samples have to be painted again. */
  look: string;
}

export interface Form {
  draw(sheet: Sheet): void;
  /** The sample under a position of the canvas. */
  sampleAt(x: number, y: number, image: SonarImage): Sample | null;
  /** Draws a ring at a sample, and its beam. */
  point(drawing: CanvasRenderingContext2D, image: SonarImage, sample: Sample, colour: string): void;
}

/** A direction in the plane of the fan as text: its azimuth, or its elevation if the fan is vertical. */
export function directionText(image: SonarImage, azimuth: number): string {
  if (image.sonar.vertical) return elevation(image.elevation(azimuth));
  return `${Math.round((azimuth * 180) / Math.PI)}°`.replace('-', '−');
}
