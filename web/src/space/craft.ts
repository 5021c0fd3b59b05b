/** Craft: the vehicle to scale; from far away as large as can be seen, within a ring. FanOutlines: the outline of each fan. */
import {
  BufferAttribute,
  BufferGeometry,
  CapsuleGeometry,
  ConeGeometry,
  BoxGeometry,
  Group,
  Line,
  LineBasicMaterial,
  Mesh,
  MeshLambertMaterial,
  MeshBasicMaterial,
  RingGeometry,
  DoubleSide,
} from 'three';
import type { Model } from '../model';
import type { Vehicle } from '../protocol';
import type { SonarImage } from '../sonar_image';
import type { Paint } from '../theme';
import { at, put } from './frame';

/** Least length of the vehicle, as a share of its distance from the camera. */
const kLeast = 0.045;

export class Craft {
  readonly group = new Group();
  private readonly hull = new MeshLambertMaterial();
  private readonly fin = new MeshLambertMaterial();
  private readonly halo = new MeshBasicMaterial({
    side: DoubleSide,
    transparent: true,
    opacity: 0.7,
    depthTest: false,
  });
  private readonly body = new Group();
  private readonly ring: Mesh;

  constructor() {
    const box = (x: number, y: number, z: number, px: number, py: number, pz: number) => {
      const mesh = new Mesh(new BoxGeometry(x, y, z), this.fin);
      mesh.position.set(px, py, pz);
      return mesh;
    };
    // One metre long, bow along y, up is z; place() sets the pose.
    const hull = new Mesh(new CapsuleGeometry(0.06, 0.76, 6, 16), this.hull);
    const tail = new Mesh(new ConeGeometry(0.058, 0.2, 16), this.hull);
    tail.rotation.x = Math.PI;
    tail.position.y = -0.46;
    this.body.add(
      hull,
      tail,
      box(0.32, 0.1, 0.012, 0, -0.4, 0),
      box(0.012, 0.1, 0.28, 0, -0.4, 0),
      box(0.02, 0.12, 0.1, 0, 0.1, 0.08),
    );
    this.ring = new Mesh(new RingGeometry(0.92, 1, 40), this.halo);
    this.ring.renderOrder = 4;
    this.group.add(this.body, this.ring);
  }

  place(vehicle: Vehicle, length: number, stretch: number, paint: Paint, distance: number): void {
    this.hull.color.set(paint.vehicle);
    this.fin.color.set(paint.decision);
    this.halo.color.set(paint.track);
    const shown = Math.max(length, kLeast * distance);
    this.body.scale.setScalar(shown);
    this.group.position.copy(at(vehicle.north, vehicle.east, vehicle.down * stretch));
    // Heading turns clockwise seen from above; pitch lifts the bow; roll puts starboard down.
    this.body.rotation.set(vehicle.pitch, vehicle.roll, -vehicle.heading, 'ZXY');
    this.ring.scale.setScalar(0.8 * shown);
  }
}

export class FanOutlines {
  readonly group = new Group();
  private readonly lines = new Map<number, { line: Line; revision: number; stretch: number }>();
  private readonly material = new LineBasicMaterial({ transparent: true, opacity: 0.85 });

  show(model: Model, stretch: number, paint: Paint): void {
    this.material.color.set(paint.decision);
    for (const [number, { line }] of this.lines) {
      if (model.sonars.has(number)) continue;
      this.group.remove(line);
      line.geometry.dispose();
      this.lines.delete(number);
    }
    for (const [number, image] of model.sonars) {
      const known = this.lines.get(number);
      if (image.newest < 0 || (known?.revision === image.revision && known.stretch === stretch)) continue;
      const places = outline(image, stretch);
      if (!known) {
        const line = new Line(new BufferGeometry(), this.material);
        line.frustumCulled = false;
        this.group.add(line);
        this.lines.set(number, { line, revision: image.revision, stretch });
      }
      const kept = this.lines.get(number)!;
      kept.line.geometry.dispose();
      kept.line.geometry = new BufferGeometry();
      kept.line.geometry.setAttribute('position', new BufferAttribute(places, 3));
      Object.assign(kept, { revision: image.revision, stretch });
    }
  }
}

/** The edge of a fan, or the latest beam of a scanning head. */
function outline(image: SonarImage, stretch: number): Float32Array {
  const { azimuth, scanning } = image.sonar;
  const order = scanning ? [image.newest] : Array.from(azimuth.keys()).sort((a, b) => azimuth[a]! - azimuth[b]!);
  const step = Math.max(1, Math.floor(order.length / 40));
  const beams = order.filter((_, i) => i % step === 0 || i === order.length - 1);
  const out = new Float32Array(3 * (beams.length + 2));
  const along = new Float64Array(3);
  const p = image.poses.subarray(image.newest * 7, image.newest * 7 + 3);
  put(out, 0, p[0]!, p[1]!, p[2]! * stretch);
  beams.forEach((beam, i) => {
    image.direction(Number.isNaN(image.heard[beam]!) ? image.newest : beam, along);
    const far = (k: number) => p[k]! + image.reach * along[k]!;
    put(out, i + 1, far(0), far(1), far(2) * stretch);
  });
  put(out, beams.length + 1, p[0]!, p[1]!, p[2]! * stretch);
  return out;
}
