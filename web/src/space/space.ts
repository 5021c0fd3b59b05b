/**
 * SpaceView: the 3-D view of voxels, bottom, vehicle, obstacles, fence, mission, route and track. Mouse, fingers or keys turn it. It is drawn only
 * when something has changed.
 */
import {
  AmbientLight,
  DirectionalLight,
  DoubleSide,
  Group,
  Mesh,
  MeshBasicMaterial,
  PlaneGeometry,
  Scene,
  Vector3,
  WebGLRenderer,
} from 'three';
import { byId, mark, say } from '../dom';
import { KeptChoices } from '../kept';
import { Kind, type Vehicle } from '../protocol';
import * as units from '../units';
import type { Shared, View } from '../view';
import { Axes } from './axes';
import { Bearings } from './bearings';
import { Course } from './course';
import { Craft, FanOutlines } from './craft';
import { EchoChoice } from './echo_choice';
import { type Extent, at, extentOf } from './frame';
import { fitText } from './labels';
import { Thread } from './lines';
import { pan, turn, zoom } from './moves';
import { farthest } from './sphere_cells';
import { SphereMesh } from './sphere_mesh';
import { kDaylight, kLight, kNightlight, kSunward } from './shading';
import { drawsInSoftware } from './software';
import { Standing } from './standing';
import { Surface } from './surface';
import { Viewpoint } from './viewpoint';
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
/** m around the vehicle that a view from above shows at least. */
const kNear = 20;

export class SpaceView implements View {
  private readonly canvas = byId<HTMLCanvasElement>('space-canvas');
  private readonly readout = byId('space-readout');
  private readonly world = new Scene();
  private readonly voxels = new VoxelMesh();
  private readonly sphere = new SphereMesh();
  private readonly surface = new Surface();
  private readonly axes = new Axes();
  private readonly bearings = new Bearings();
  private readonly standing = new Standing();
  private readonly course = new Course();
  private readonly craft = new Craft();
  private readonly fans = new FanOutlines();
  private readonly track = new Thread();
  private readonly way = new Thread();
  private readonly stretched = new Group();
  private readonly sea: Mesh<PlaneGeometry, MeshBasicMaterial>;
  private renderer: WebGLRenderer | null = null;
  private readonly boxes = {
    voxels: byId<HTMLInputElement>('space-voxels'),
    bottom: byId<HTMLInputElement>('space-bottom'),
    water: byId<HTMLInputElement>('space-water'),
    obstacles: byId<HTMLInputElement>('space-obstacles'),
    fence: byId<HTMLInputElement>('space-fence'),
    mission: byId<HTMLInputElement>('space-mission'),
    fan: byId<HTMLInputElement>('space-fan'),
    sphere: byId<HTMLInputElement>('space-sphere'),
    bearings: byId<HTMLInputElement>('space-bearings'),
    follow: byId<HTMLInputElement>('space-follow'),
    course: byId<HTMLInputElement>('space-course'),
  };
  private readonly colour = byId<HTMLSelectElement>('space-colour');
  private readonly stretching = byId<HTMLSelectElement>('space-stretch');
  private readonly echoes = new EchoChoice(() => this.touch());
  private readonly choices = new KeptChoices('isobath-space', [
    ...Object.values(this.boxes),
    this.colour,
    this.stretching,
    this.echoes.coarser,
    this.echoes.which,
  ]);
  private readonly viewpoint = new Viewpoint(this.boxes.follow, this.boxes.course, () => this.choices.keep());
  private readonly ambient = new AmbientLight(0xffffff, 1.5);
  private readonly sun = new DirectionalLight(0xffffff, 2);
  private dirty = true;
  private seen = '';
  private built = '';
  private cubed = '';
  private shown = NaN;
  private jumped = -Infinity;
  private rebuilt = -Infinity;
  /** Whether all voxels were requested, and in which connection. */
  private wanted = '';
  private deepest = 1;

  constructor(private readonly shared: Shared) {
    this.sea = new Mesh(
      new PlaneGeometry(1, 1),
      new MeshBasicMaterial({ transparent: true, opacity: 0.16, side: DoubleSide, depthWrite: false }),
    );
    this.stretched.add(this.voxels.mesh, this.sphere.mesh, this.surface.group, this.standing.group);
    this.sun.position.copy(kSunward);
    this.world.add(this.ambient, this.sun, this.stretched, this.axes.group, this.bearings.group, this.course.group, this.sea);
    this.world.add(this.craft.group, this.fans.group, this.track.line, this.way.line);
    byId('space-echoes').hidden = !this.boxes.sphere.checked;
    for (const input of this.choices.inputs) input.addEventListener('change', () => this.touch());
    this.colour.addEventListener('change', () => (this.cubed = ''));
    this.boxes.follow.addEventListener('change', () => {
      if (!this.viewpoint.above) this.viewpoint.placed = false;
    });
    byId('space-fit').addEventListener('click', () => {
      this.viewpoint.placed = false;
      this.touch();
    });
    byId('space-above').addEventListener('click', () => this.lookDown());
    this.canvas.addEventListener('pointerdown', () => this.canvas.focus());
  }

  private touch(): void {
    byId('space-echoes').hidden = !this.boxes.sphere.checked;
    this.dirty = true;
    this.built = '';
    this.rebuilt = -Infinity;
    this.shared.redraw();
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
    this.viewpoint.camera.aspect = width / height;
    this.viewpoint.camera.updateProjectionMatrix();
    renderer.setClearColor(theme.paint.sky);
    kLight.copy(theme.name === 'day' ? kDaylight : kNightlight);
    [this.ambient.intensity, this.sun.intensity] = [kLight.x, kLight.y];
    this.rebuild(now, now - this.jumped < kArrives);
    this.move();
    for (const { group } of [this.axes, this.bearings, this.course]) fitText(group, height);
    renderer.render(this.world, this.viewpoint.camera);
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
      this.viewpoint.stay();
      pan(camera, target, right, ahead);
    });
  }
  follow(): void {
    this.boxes.follow.click();
  }

  /** Looks down on the vehicle and on what the view shows around it. */
  lookDown(): void {
    const { model } = this.shared;
    if (!this.renderer || !model.vehicle) return;
    const sphere = this.boxes.sphere.checked ? this.echoes.of(model.sphere) : null;
    const sonars = [...model.sonars.values()].map(({ sonar }) => sonar.first + sonar.bin * sonar.bins);
    const reach = (sphere && farthest(sphere)) || Math.max(0, ...sonars);
    this.viewpoint.lookDown(this.placeOf(model.vehicle), Math.max(kNear, 1.25 * reach));
    this.dirty = this.moved = true;
    this.shared.redraw();
  }

  private moveCamera(by: (camera: Vector3, target: Vector3) => void): void {
    if (!this.renderer) return;
    this.viewpoint.moveBy(by);
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
    this.viewpoint.start(this.canvas, () => {
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
    this.voxels.colour = this.colour.value as VoxelColour;
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
      if (!this.viewpoint.placed) this.viewpoint.lookAt(extent, model.vehicle && this.placeOf(model.vehicle));
    }
    const cubes = `${model.revision[Kind.voxels]} ${model.revision[Kind.cubes]} ${theme.revision}`;
    if (cubes !== this.cubed) this.voxels.build(model, theme);
    this.cubed = cubes;
    if (this.boxes.sphere.checked) this.sphere.build(this.echoes.of(model.sphere), theme.name !== 'day');
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

  private move(): void {
    const { model, theme } = this.shared;
    const { paint } = theme;
    const { vehicle, scene } = model;
    this.craft.group.visible = vehicle !== null;
    this.bearings.group.visible = vehicle !== null && this.boxes.bearings.checked;
    if (vehicle) {
      const place = this.placeOf(vehicle);
      this.viewpoint.goWith(place, vehicle.heading);
      this.craft.place(
        vehicle,
        scene?.vehicle.length ?? 1.5,
        this.stretch,
        paint,
        this.viewpoint.camera.position.distanceTo(place),
      );
      const heading = this.boxes.course.checked ? vehicle.heading : null;
      // Seen from above, the rings replace the axes.
      this.axes.group.visible = !(this.boxes.bearings.checked && this.viewpoint.above);
      if (this.boxes.bearings.checked) this.bearings.show(place, heading, this.viewpoint.room(place), paint);
    }
    this.fans.show(model, this.stretch, paint);
    const of = (...kinds: Kind[]) => kinds.map((kind) => model.revision[kind]).join(' ');
    const shows = { fence: this.boxes.fence.checked, obstacles: this.boxes.obstacles.checked };
    this.standing.show(model, of(Kind.scene, Kind.obstacles), shows, this.deepest, paint);
    this.course.show(model, of(Kind.scene, Kind.depth), this.deepest, this.stretch, paint);
    this.course.group.visible = this.boxes.mission.checked;
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

  private get stretch(): number {
    return Number(this.stretching.value);
  }
  private placeOf(vehicle: Vehicle): Vector3 {
    return at(vehicle.north, vehicle.east, vehicle.down * this.stretch);
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
    if (this.boxes.sphere.checked) parts.push(...this.echoes.words(this.shared.theme.name !== 'day'));
    if (this.boxes.obstacles.checked) parts.push(`${this.standing.obstacles} ${this.standing.obstacles === 1 ? 'obstacle' : 'obstacles'}`);
    if (this.shared.model.depth.size > 0 && this.boxes.bottom.checked)
      parts.push(`bottom from 0 m (light) to ${this.deepest} m deep (dark)`);
    say(this.readout, parts.join(' · '));
    mark(this.canvas, 'voxels', String(this.voxels.shown));
    const { bearing, down } = this.viewpoint.looks;
    mark(this.canvas, 'looks', `${units.bearing(bearing)} ${units.elevation(-down)}`);
    const { lines, rings, group } = this.bearings;
    mark(this.canvas, 'bearings', group.visible ? [...lines, ...rings].join() : '');
  }
}

function level([n, e, d]: readonly [number, number, number], instead: number): [number, number, number] {
  return [n, e, Number.isFinite(d) ? d : instead];
}
