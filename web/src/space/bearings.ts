/**
 * Bearings: dotted lines every 30 degrees in the level plane of the vehicle, and rings at round distances. The lines have
 * bearings from north or, while the camera turns with the vehicle, from the bow (ledger S4-39, S4-19, S4-20).
 */
import { Group, LineDashedMaterial, LineSegments, type Vector3 } from 'three';
import type { Paint } from '../theme';
import * as units from '../units';
import { geometryOf, put } from './frame';
import { clear, label } from './labels';

const kLines = 12;
const kTurn = 2 * Math.PI;
/** Pieces of a ring. */
const kPieces = 96;
/** Bearing of the distances, rad: beside the first line. */
const kDistances = kTurn / 36;

export class Bearings {
  readonly group = new Group();
  /** What is written at the lines, clockwise, and at the rings. */
  lines: string[] = [];
  rings: string[] = [];
  private look = '';

  /** Around the vehicle, in a view that has room for `room` metres. Heading: that from which bearings count. */
  show(vehicle: Vector3, heading: number | null, room: number, paint: Paint): void {
    this.group.position.copy(vehicle);
    this.group.rotation.z = -(heading ?? 0);
    const within = 0.8 * room;
    const step = units.roundStep(within / 5);
    const count = Math.max(1, Math.floor(within / step));
    const look = [heading === null, step, count, paint.ink, paint.halo].join();
    if (look === this.look) return;
    this.look = look;
    clear(this.group);
    const reach = step * count;
    const spokes: number[] = [];
    const circles: number[] = [];
    const level = (radius: number, bearing: number): [number, number] => [
      radius * Math.cos(bearing),
      radius * Math.sin(bearing),
    ];
    const write = (words: string, radius: number, bearing: number) => {
      const sprite = label(words, paint);
      const [north, east] = level(radius, bearing);
      sprite.position.set(east, north, 0);
      this.group.add(sprite);
    };
    this.lines = [];
    for (let i = 0; i < kLines; ++i) {
      const bearing = (i * kTurn) / kLines;
      spokes.push(...level(0.1 * step, bearing), ...level(reach, bearing));
      const words = heading === null ? units.bearing(bearing) : units.fromBow((i * 360) / kLines);
      this.lines.push(words);
      write(words, reach + 0.1 * room, bearing);
    }
    this.rings = [];
    for (let ring = 1; ring <= count; ++ring) {
      for (let i = 0; i < kPieces; ++i) {
        for (const end of [i, i + 1]) circles.push(...level(ring * step, (end * kTurn) / kPieces));
      }
      const words = units.roundMetres(ring * step);
      this.rings.push(words);
      write(words, ring * step, kDistances);
    }
    const dash = step / 24;
    this.group.add(dashed(spokes, paint.ink, dash), dashed(circles, paint.faint, dash));
  }
}

/** Line segments between pairs of (north, east). */
function dashed(level: readonly number[], color: string, dash: number): LineSegments {
  const places = new Float32Array((3 * level.length) / 2);
  for (let i = 0; 2 * i < level.length; ++i) put(places, i, level[2 * i]!, level[2 * i + 1]!, 0);
  const lines = new LineSegments(geometryOf(places), new LineDashedMaterial({ color, dashSize: dash, gapSize: dash }));
  lines.computeLineDistances();
  return lines;
}
