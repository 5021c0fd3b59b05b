/**
 * SpaceView: the 3-D view of voxels, bottom, vehicle, route and track. Mouse, fingers or keys turn it. It is drawn only
 * when something has changed.
 */
import {
  AmbientLight,
  DirectionalLight,
  DoubleSide,
  Group,
  Mesh,
  MeshBasicMaterial,
  PerspectiveCamera,
  PlaneGeometry,
  Scene,
  Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { byId, mark, say } from '../dom';
import { Kind } from '../protocol';
import * as units from '../units';
import type { Shared, View } from '../view';
import { Axes } from './axes';
import { Craft, FanOutlines } from './craft';
import { type Extent, at, extentOf } from './frame';
import { Thread } from './lines';
import { pan, turn, zoom } from './moves';
import { SphereMesh } from './sphere_mesh';
import { kDaylight, kLight, kNightlight, kSunward } from './shading';
import { drawsInSoftware } from './software';
import { Surface } from './surface';
import { VoxelMesh, type VoxelColour } from './voxel_mesh';

/** ms between two rebuilds of the expensive parts. */
const kRebuild = 300;
/** ms between two pictures while things move, if the CPU draws them. */
const kSlow = 400;
/** Cubes that the CPU draws while things change, and cubes once nothing has changed for kRest ms. */
const [kSlowCubes, kRestCubes, kRest] = [10_000, 40_000, 600];
/** s of the run at speed 1: a longer step is a jump. */
const kJump = 3;
/** Voxels per drawable cube: inner voxels are not drawn, and larger cubes represent the rest. */
const kVoxelsEach = 4;
/** ms after a jump in which everything is drawn at once, because the sought items arrive in pieces. */
const kArrives = 500;

export class SpaceView implements View {
  private readonly canvas = byId<HTMLCanvasElement>('space-canvas');
  private readonly readout = byId('space-readout');
  private readonly world = new Scene();
  private readonly camera = new PerspectiveCamera(45, 1, 0.1, 20000);
  private readonly voxels = new VoxelMesh();
  private readonly sphere = new SphereMesh();
  private readonly surface = new Surface();
  private readonly axes = new Axes();
  private readonly craft = new Craft();
  private readonly fans = new FanOutlines();
  private readonly track = new Thread();
  private readonly way = new Thread();
  private readonly stretched = new Group();
  private readonly sea: Mesh<PlaneGeometry, MeshBasicMaterial>;
  private renderer: WebGLRenderer | null = null;
  private controls: OrbitControls | null = null;
  private readonly boxes = {
    voxels: byId<HTMLInputElement>('space-voxels'),
    bottom: byId<HTMLInputElement>('space-bottom'),
    water: byId<HTMLInputElement>('space-water'),
    fan: byId<HTMLInputElement>('space-fan'),
    sphere: byId<HTMLInputElement>('space-sphere'),
    follow: byId<HTMLInputElement>('space-follow'),
    course: byId<HTMLInputElement>('space-course'),
  };
  private readonly ambient = new AmbientLight(0xffffff, 1.5);
  private readonly sun = new DirectionalLight(0xffffff, 2);
  private stretch = 1;
  private dirty = true;
  private seen = '';
  private built = '';
  private cubed = '';
  private shown = NaN;
  private jumped = -Infinity;
  private rebuilt = -Infinity;
  private placed = false;
  /** Whether all voxels were requested, and in which connection. */
  private wanted = '';
  private deepest = 1;
  /** Target of the camera while it follows the vehicle. */
  private followed: Vector3 | null = null;
  /** The heading that the camera has turned to, while it turns with the vehicle; rad. */
  private turned: number | null = null;

  constructor(private readonly shared: Shared) {
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(-60, -90, 70);
    this.sea = new Mesh(
      new PlaneGeometry(1, 1),
      new MeshBasicMaterial({ transparent: true, opacity: 0.16, side: DoubleSide, depthWrite: false }),
    );
    this.stretched.add(this.voxels.mesh, this.sphere.mesh, this.surface.group);
    this.sun.position.copy(kSunward);
    this.world.add(this.ambient, this.sun, this.stretched, this.axes.group, this.sea);
    this.world.add(this.craft.group, this.fans.group, this.track.line, this.way.line);
    const touch = () => {
      this.dirty = true;
      this.built = this.cubed = '';
      this.rebuilt = -Infinity;
      shared.redraw();
    };
    for (const box of Object.values(this.boxes)) box.addEventListener('change', touch);
    this.boxes.follow.addEventListener('change', () => (this.placed = false));
    const colour = byId<HTMLSelectElement>('space-colour');
    colour.addEventListener('change', () => {
      this.voxels.colour = colour.value as VoxelColour;
      touch();
    });
    const stretch = byId<HTMLSelectElement>('space-stretch');
    stretch.addEventListener('change', () => {
      this.stretch = Number(stretch.value);
      touch();
    });
    byId('space-fit').addEventListener('click', () => {
      this.placed = false;
      touch();
    });
    this.canvas.addEventListener('pointerdown', () => this.canvas.focus());
  }

  frame(now: number): void {
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    const visible = width >= 20 && height >= 20 && this.start();
    this.askForVoxels(visible);
    if (!visible) return;
    const { model, theme } = this.shared;
    const renderer = this.renderer!;
    const look = `${model.revision.join()} ${theme.revision} ${width} ${height}`;
    if (look !== this.seen) this.dirty = true;
    if (this.slow) this.rest(now);
    if (!this.dirty) return;
    if (Math.abs(model.now - this.shown) > kJump * Math.max(1, model.clock?.speed ?? 1)) this.jumped = now;
    this.shown = model.now;
    const atOnce = this.moved || now - this.jumped < kArrives;
    if (this.slow && !atOnce && now - this.rendered < kSlow) return;
    this.rendered = now;
    this.seen = look;
    this.dirty = this.moved = false;
    renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    renderer.setClearColor(theme.paint.sky);
    kLight.copy(theme.name === 'day' ? kDaylight : kNightlight);
    [this.ambient.intensity, this.sun.intensity] = [kLight.x, kLight.y];
    this.rebuild(now, now - this.jumped < kArrives);
    this.move();
    renderer.render(this.world, this.camera);
    this.tell();
  }

  /** Draws finer cubes once nothing has changed for a while. */
  private rest(now: number): void {
    if (this.dirty) this.changed = now;
    const rests = now - this.changed > kRest;
    const most = rests ? kRestCubes : kSlowCubes;
    if (most === this.voxels.most || (rests && this.voxels.side === 1)) return;
    this.voxels.most = most;
    this.built = this.cubed = '';
    this.rebuilt = -Infinity;
    this.dirty = true;
  }

  /** Requests all voxels only if they are visible and few enough to draw. */
  private askForVoxels(visible: boolean): void {
    const { model } = this.shared;
    let count = 0;
    for (const { item } of model.cubes.values()) count += item.count;
    const all = visible && this.boxes.voxels.checked && count <= kVoxelsEach * (this.slow ? kRestCubes : this.voxels.most);
    const wanted = `${all} ${model.revision[0]}`;
    if (wanted === this.wanted || (!all && !this.wanted.startsWith('true'))) return;
    if (!this.shared.wantVoxels(all)) return; // a stored run has all voxels; a socket is not connected
    this.wanted = wanted;
    if (!all) model.dropVoxels();
  }

  get behind(): boolean {
    return this.dirty && this.canvas.clientWidth >= 20 && !this.failed;
  }

  zoomBy(factor: number): void {
    this.moveCamera((camera, target) => zoom(camera, target, factor));
  }
  turnBy(right: number, up: number): void {
    this.moveCamera((camera, target) => turn(camera, target, right, up));
  }
  panBy(right: number, ahead: number): void {
    this.moveCamera((camera, target) => {
      this.boxes.follow.checked = false;
      pan(camera, target, right, ahead);
    });
  }
  follow(): void {
    this.boxes.follow.click();
  }

  private moveCamera(by: (camera: Vector3, target: Vector3) => void): void {
    if (!this.controls) return;
    by(this.camera.position, this.controls.target);
    this.controls.update();
    this.dirty = true;
    this.shared.redraw();
  }

  /** Starts WebGL when this view is first visible, so that it costs nothing before. */
  private start(): boolean {
    if (this.renderer) return true;
    if (this.failed) return false;
    try {
      this.slow = drawsInSoftware();
      this.surface.most = this.slow ? 20_000 : 600_000;
      this.voxels.most = this.slow ? kSlowCubes : 300_000;
      this.renderer = new WebGLRenderer({ canvas: this.canvas, antialias: !this.slow });
    } catch {
      this.failed = true;
      byId('space-none').hidden = false;
      return false;
    }
    this.renderer.setPixelRatio(this.slow ? 1 : Math.min(2, window.devicePixelRatio || 1));
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.zoomToCursor = true;
    this.controls.maxPolarAngle = Math.PI * 0.92;
    this.controls.addEventListener('change', () => {
      this.dirty = this.moved = true;
      this.shared.redraw();
    });
    return true;
  }
  private failed = false;
  /** The CPU draws: fewer points, and fewer pictures, to leave time for the other views. */
  private slow = false;
  private moved = false;
  private rendered = -Infinity;
  private changed = -Infinity;

  private rebuild(now: number, atOnce: boolean): void {
    const { model, theme } = this.shared;
    const stretch = this.stretch;
    const revisions = [Kind.voxels, Kind.cubes, Kind.depth, Kind.sphere, Kind.scene].map((kind) => model.revision[kind]);
    const look = `${revisions.join()} ${theme.revision}`;
    if (look === this.built) return;
    if (!atOnce && now - this.rebuilt < kRebuild) {
      this.dirty = true; // soon
      this.shared.redraw();
      return;
    }
    this.rebuilt = now;
    const extent = extentOf(this.shared.model);
    if (!extent.empty) {
      this.deepest = Math.max(1, Math.ceil(extent.high[2]!));
      this.axes.build(extent, stretch, theme.paint);
      this.spreadSea(extent);
      if (!this.placed) this.lookAt(extent);
    }
    const cubes = `${model.revision[Kind.voxels]} ${model.revision[Kind.cubes]} ${theme.revision}`;
    if (cubes !== this.cubed) this.voxels.build(model, theme);
    this.cubed = cubes;
    if (this.boxes.sphere.checked) this.sphere.build(model.sphere, theme.name !== 'day');
    this.sphere.mesh.visible = this.boxes.sphere.checked;
    const more = this.surface.build(model, theme, this.deepest);
    this.stretched.scale.set(1, 1, stretch);
    if (more) {
      this.dirty = true;
      this.rebuilt = -Infinity;
      this.shared.redraw();
    } else {
      this.built = look;
    }
    this.voxels.mesh.visible = this.boxes.voxels.checked;
    this.surface.group.visible = this.boxes.bottom.checked;
    this.sea.visible = this.boxes.water.checked;
    this.sea.material.color.set(theme.paint.track);
    this.fans.group.visible = this.boxes.fan.checked;
  }

  private spreadSea(extent: Extent): void {
    const [n, e] = [0, 1].map((k) => (extent.low[k]! + extent.high[k]!) / 2) as [number, number];
    this.sea.position.copy(at(n, e, 0));
    this.sea.scale.set(extent.high[1]! - extent.low[1]!, extent.high[0]! - extent.low[0]!, 1);
  }

  private lookAt(extent: Extent): void {
    this.placed = true;
    this.followed = null;
    const { vehicle } = this.shared.model;
    const wide = Math.max(20, extent.high[0]! - extent.low[0]!, extent.high[1]! - extent.low[1]!);
    const [n, e] = [0, 1].map((k) => (extent.low[k]! + extent.high[k]!) / 2) as [number, number];
    const follows = this.boxes.follow.checked && vehicle;
    const target = follows ? at(vehicle.north, vehicle.east, vehicle.down * this.stretch) : at(n, e, 0);
    this.controls!.target.copy(target);
    const half = (this.camera.fov / 2) * (Math.PI / 180);
    const narrow = Math.min(half, Math.atan(Math.tan(half) * this.camera.aspect));
    const far = follows ? Math.min(wide, 70) : (0.61 * wide) / Math.sin(narrow);
    this.camera.position.copy(target).add(new Vector3(-0.4, -0.75, 0.62).normalize().multiplyScalar(far));
    this.camera.far = wide * 20;
    this.controls!.update();
  }

  private move(): void {
    const { model, theme } = this.shared;
    const { paint } = theme;
    const { vehicle, scene } = model;
    this.craft.group.visible = vehicle !== null;
    if (vehicle) {
      const place = at(vehicle.north, vehicle.east, vehicle.down * this.stretch);
      const { target } = this.controls!;
      // Dragging the view away ends following.
      if (this.followed && target.distanceTo(this.followed) > 1e-3) this.boxes.follow.checked = false;
      this.followed = null;
      if (this.boxes.follow.checked) {
        this.camera.position.add(place.clone().sub(target));
        target.copy(place);
        this.controls!.update();
        this.followed = place;
        this.dirty = this.moved = false;
      }
      this.turnWith(vehicle.heading);
      this.controls!.zoomToCursor = !this.boxes.follow.checked;
      this.craft.place(
        vehicle,
        scene?.vehicle.length ?? 1.5,
        this.stretch,
        paint,
        this.camera.position.distanceTo(place),
      );
    }
    this.fans.show(model, this.stretch, paint);
    const points = model.way?.points ?? [];
    this.way.show(points.length, (i) => level(points[i]!, vehicle?.down ?? 0), this.stretch, paint.way);
    const pieces = [...model.track.entries()].sort(([a], [b]) => a - b).map(([, piece]) => piece.places);
    const all = pieces.reduce((sum, piece) => sum + piece.length / 4, 0);
    let piece = 0;
    let first = 0;
    this.track.show(
      all,
      (i) => {
        while (i - first >= pieces[piece]!.length / 4) first += pieces[piece++]!.length / 4;
        const k = 4 * (i - first);
        return [pieces[piece]![k + 1]!, pieces[piece]![k + 2]!, pieces[piece]![k + 3]!];
      },
      this.stretch,
      paint.track,
    );
  }

  /** With the course up the camera looks ahead from astern at first, and then turns about its target as the vehicle does. */
  private turnWith(heading: number): void {
    if (!this.boxes.course.checked) {
      this.turned = null;
      return;
    }
    const { target } = this.controls!;
    const arm = this.camera.position.clone().sub(target);
    const astern = -Math.PI / 2 - heading; // from east towards north
    const by = this.turned === null ? astern - Math.atan2(arm.y, arm.x) : this.turned - heading;
    this.turned = heading;
    mark(this.canvas, 'heading', String(Math.round((heading * 180) / Math.PI)));
    if (by === 0) return;
    this.camera.position.copy(target).add(arm.applyAxisAngle(this.camera.up, by));
    this.controls!.update();
    this.dirty = this.moved = false;
  }

  private tell(): void {
    const { vehicle } = this.shared.model;
    const parts = vehicle
      ? [
          `${units.metres(vehicle.down)} deep, ${units.metres(vehicle.altitude)} above the bottom`,
          `roll ${units.tilt(vehicle.roll)}, pitch ${units.tilt(vehicle.pitch)}`,
        ]
      : [];
    parts.push(
      `${units.count(this.voxels.shown)} ${this.voxels.side > 1 ? `cubes of ${this.voxels.side}³ ` : ''}voxels`,
    );
    if (this.voxels.shown > 0 && this.voxels.colour === 'depth') {
      parts.push(
        `voxels from ${units.metres(this.voxels.range[0])} (light) to ${units.metres(this.voxels.range[1])} deep`,
      );
    } else if (this.voxels.shown > 0) {
      parts.push('voxels from 50 % (dark) to 100 % occupied (light)');
    }
    if (this.boxes.sphere.checked && this.sphere.shown > 0)
      parts.push(`${units.count(this.sphere.shown)} cells with echoes around the vehicle, ${this.sphere.locked} locked`);
    if (this.shared.model.depth.size > 0 && this.boxes.bottom.checked)
      parts.push(`bottom from 0 m (light) to ${this.deepest} m deep (dark)`);
    say(this.readout, parts.join(' · '));
    mark(this.canvas, 'voxels', String(this.voxels.shown));
    mark(this.canvas, 'sphere', String(this.boxes.sphere.checked ? this.sphere.shown : 0));
  }
}

function level([n, e, d]: readonly [number, number, number], instead: number): [number, number, number] {
  return [n, e, Number.isFinite(d) ? d : instead];
}
