/** Course: the mission points at their depths, below stakes from the surface, with the legs between them. */
import { type BufferGeometry, Group, LineBasicMaterial, LineDashedMaterial, LineSegments } from 'three';
import type { MissionPoint } from '../items';
import type { Model } from '../model';
import type { Paint } from '../theme';
import { at, geometryOf, put } from './frame';
import { clear, label } from './labels';

export class Course {
  readonly group = new Group();
  private look = '';

  /** `revision`: grows when the mission or the depth map of the model has changed. */
  show(model: Model, revision: string, deepest: number, stretch: number, paint: Paint): void {
    const look = [revision, deepest, stretch, paint.mission, paint.halo].join();
    if (look === this.look) return;
    this.look = look;
    clear(this.group);
    const points = model.scene?.mission ?? [];
    const stakes: Place[] = [];
    const legs: Place[] = [];
    let last: Place | null = null;
    points.forEach((point, i) => {
      const [north, east] = point.at;
      const down = downOf(point, model);
      stakes.push([north, east, 0], [north, east, (down ?? deepest) * stretch]);
      const place: Place | null = down === null ? null : [north, east, down * stretch];
      if (place && last && !point.apart) legs.push(last, place);
      last = place;
      const name = label(`◎ ${point.name || i + 1}`, paint, paint.mission);
      name.position.copy(at(...(place ?? [north, east, 0])));
      this.group.add(name);
    });
    if (stakes.length > 0) this.group.add(new LineSegments(through(stakes), new LineBasicMaterial({ color: paint.mission })));
    if (legs.length === 0) return;
    const dashes = new LineDashedMaterial({ color: paint.mission, dashSize: 1, gapSize: 1 });
    this.group.add(new LineSegments(through(legs), dashes).computeLineDistances());
  }
}

type Place = readonly [number, number, number];

/** Depth of a point, m; null: it counts from a bottom that is not known there. */
function downOf({ depth, altitude, at: [north, east] }: MissionPoint, model: Model): number | null {
  if (depth !== undefined) return depth;
  const bottom = model.depthAt(north, east);
  return altitude === undefined || !bottom ? null : Math.max(0, bottom.depth - altitude);
}

function through(places: readonly Place[]): BufferGeometry {
  const positions = new Float32Array(3 * places.length);
  places.forEach((place, i) => put(positions, i, ...place));
  return geometryOf(positions);
}
