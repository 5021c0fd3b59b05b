/**
 * Sounds of the passive array: a line from the vehicle in the direction of each, as far as the obstacle that it comes
 * from (solid), else dashed, with its frequency and its origin.
 */
import type { Model } from '../model';
import { soundText, type Sound } from '../sounds';
import { label, stroke, trace, type Pen } from './pen';

/** m: length of a line to a sound whose distance is unknown. */
const kFar = 150;

function end({ bearing, from, to }: Sound): readonly [number, number] {
  return to ?? [from[0] + kFar * Math.cos(bearing), from[1] + kFar * Math.sin(bearing)];
}

export function drawSounds(pen: Pen, model: Model): void {
  const { camera, drawing, paint } = pen;
  for (const sound of model.sounds) {
    const line = [sound.from, end(sound)];
    const attached = (sound.obstacle ?? 0) > 0;
    trace(pen, line, false);
    stroke(pen, { colour: paint.halo, width: 5 });
    trace(pen, line, false);
    stroke(pen, { colour: paint.sound, width: 2, dash: attached ? [] : [8, 5] });
    const [x, y] = [camera.x(...line[1]!), camera.y(...line[1]!)];
    if (sound.to) {
      drawing.beginPath();
      drawing.arc(x, y, 5, 0, 2 * Math.PI);
      stroke(pen, { colour: paint.sound, width: 2 });
    }
    const [a, b] = line.map((p) => [camera.x(...p), camera.y(...p)] as const);
    const share = sound.to ? 0.6 : 0.4;
    label(pen, soundText(sound), a![0] + share * (b![0] - a![0]), a![1] + share * (b![1] - a![1]), paint.sound);
  }
}
