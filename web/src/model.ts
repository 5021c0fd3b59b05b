/**
 * Model: what the page knows of a run, the newest version of each item. Views read it; only records change it.
 *
 * Each kind has a revision that grows with every change. Items that are expensive to draw (tiles, blocks, sonars) have
 * their own revision, so that a view redraws only what has changed. There are no callbacks.
 * Errors: a record that cannot be understood changes nothing and is counted by its kind.
 */
import * as items from './items';
import * as protocol from './protocol';
import { Kind } from './protocol';
import { EchoTrail } from './echo_trail';
import { PackedRecords } from './packed_records';
import { readLevels, type Level } from './levels';
import { readPartner, type Partner } from './partners';
import { readPreview, type Preview } from './preview';
import { SignalHistory } from './signals';
import { readSounds, type Sound } from './sounds';
import { SonarImage } from './sonar_image';

export interface TrackPiece {
  revision: number;
  places: Float32Array;
}
export interface Revised<T> {
  revision: number;
  item: T;
}

const kMostDecisions = 5000;
const kMostWaiting = 4096;
const asSigned = (half: number) => half | 0;

interface Waiting {
  low: number;
  time: number;
  payload: DataView;
}

export class Model {
  scene: items.Scene | null = null;
  vehicle: protocol.Vehicle | null = null;
  /** Time of the item of that name, s since 1970; NaN: there is none yet. */
  vehicleTime = NaN;
  gridTime = NaN;
  readonly track = new Map<number, TrackPiece>();
  readonly sonars = new Map<number, SonarImage>();
  readonly trail = new EchoTrail();
  readonly signals = new SignalHistory();
  grid: protocol.Grid | null = null;
  obstacles: items.Obstacle[] = [];
  pieces: items.Piece[] = [];
  way: items.Way | null = null;
  /** In the order of their numbers. */
  decisions: items.Decision[] = [];
  readonly depth = new Map<string, Revised<protocol.DepthTile>>();
  readonly voxels = new Map<string, Revised<protocol.VoxelBlock>>();
  /** The same voxels in larger cubes. */
  readonly cubes = new Map<string, Revised<protocol.VoxelBlock>>();
  /** The spherical grid. */
  sphere: protocol.Sphere | null = null;
  /** What the passive array hears. */
  sounds: Sound[] = [];
  levels: Level[] = [];
  /** By the index of the vehicle in the group. */
  readonly partners = new Map<number, Partner>();
  health: items.Health | null = null;
  /** Times of the stages by a real clock; in a live view only. */
  times: items.StageTime[] = [];
  clock: items.Clock | null = null;
  refusal: items.Refusal | null = null;
  /** The answer to the last preview that this page asked for. */
  preview: Preview | null = null;

  /** By kind; [0] grows whenever everything is forgotten. */
  readonly revision = new Uint32Array(protocol.kLastKind + 1);
  readonly malformed = new Map<string, number>();
  records = 0;
  /** Time of the newest record, s since 1970. */
  newest = NaN;
  private stamp = 0;
  /** By sonar: echoes that came before the description of their sonar, as happens in a complete set. */
  private readonly waiting = new Map<number, Waiting[]>();
  private readonly packed = new PackedRecords();

  /** Applies a message. */
  take(bytes: Uint8Array): void {
    const read = protocol.readRecords(bytes, (record) => {
      if (record.kind === Kind.packed) return this.unpack(record);
      ++this.records;
      if (record.forget) this.forget();
      if (record.forgetKind && record.kind === Kind.voxels) this.dropVoxels();
      const taken = record.gone ? this.remove(record) : this.put(record);
      if (!taken) return this.count(kindName(record.kind));
      ++this.revision[record.kind]!;
      if (record.kind !== Kind.scene && record.kind !== Kind.clock && !(record.time <= this.newest)) {
        this.newest = record.time;
      }
    });
    if (read < bytes.length) this.count('message cut short');
    if (this.scene) this.signals.belongTo(`${this.scene.start} ${this.clock?.run ?? ''}`);
  }

  private unpack({ low, payload }: protocol.RecordView): void {
    const slice = protocol.readSlice(payload);
    const records = slice ? this.packed.take(low, slice) : undefined;
    if (records === undefined) this.count('packed records');
    else if (records) this.take(records);
  }

  forget(): void {
    this.signals.begin();
    this.scene = this.vehicle = this.grid = this.way = this.health = this.clock = this.refusal = this.sphere = null;
    this.vehicleTime = this.gridTime = this.newest = NaN;
    this.obstacles = [];
    this.pieces = [];
    this.decisions = [];
    this.times = [];
    this.sounds = [];
    this.levels = [];
    for (const map of [this.partners, this.track, this.sonars, this.depth, this.voxels, this.cubes, this.waiting]) map.clear();
    this.trail.clear();
    for (let kind = 0; kind < this.revision.length; ++kind) ++this.revision[kind]!;
  }

  /** Frees the voxels, which need much memory, while no view shows them. */
  dropVoxels(): void {
    this.voxels.clear();
    ++this.revision[Kind.voxels]!;
  }

  /** Time that is shown, s since the start. */
  get now(): number {
    if (this.clock) return this.clock.now;
    return this.scene && Number.isFinite(this.newest) ? this.newest - this.scene.start : 0;
  }
  /** Age at the shown time of something from `time`, s; NaN: unknown. */
  age(time: number): number {
    return this.scene ? this.scene.start + this.now - time : NaN;
  }

  /** Depth of the bottom at a position; null: unknown. */
  depthAt(north: number, east: number): { depth: number; confidence: number; flags: number } | null {
    for (const { item } of this.depth.values()) {
      const row = Math.floor((north - item.north) / item.pixel);
      const column = Math.floor((east - item.east) / item.pixel);
      if (row < 0 || column < 0 || row >= item.side || column >= item.side) continue;
      const i = row * item.side + column;
      const depth = item.depth[i]!;
      return Number.isNaN(depth) ? null : { depth, confidence: item.confidence[i]!, flags: item.flags[i]! };
    }
    return null;
  }

  private count(what: string): void {
    this.malformed.set(what, (this.malformed.get(what) ?? 0) + 1);
  }

  private put(record: protocol.RecordView): boolean {
    const { payload, high, low, time } = record;
    switch (record.kind) {
      case Kind.scene:
        return this.keep(items.readScene(protocol.readJson(payload)), (scene) => (this.scene = scene));
      case Kind.vehicle:
        this.vehicleTime = time;
        return this.keep(protocol.readVehicle(payload), (vehicle) => (this.vehicle = vehicle));
      case Kind.track:
        return this.keep(protocol.readTrack(payload), (places) =>
          this.track.set(low, { revision: ++this.stamp, places }),
        );
      case Kind.sonar:
        return this.keep(items.readSonar(protocol.readJson(payload)), (sonar) => {
          this.sonars.set(low, new SonarImage(sonar, this.sonars.get(low)));
          for (const echoes of this.waiting.get(low) ?? []) this.hear(low, echoes);
          this.waiting.delete(low);
        });
      case Kind.echoes:
        return this.hear(high, { low, time, payload });
      case Kind.grid:
        this.gridTime = time;
        return this.keep(protocol.readGrid(payload), (grid) => (this.grid = grid));
      case Kind.obstacles:
        return this.keep(items.readObstacles(protocol.readJson(payload)), ({ obstacles, pieces }) => {
          this.obstacles = obstacles;
          this.pieces = pieces;
        });
      case Kind.way:
        return this.keep(items.readWay(protocol.readJson(payload)), (way) => (this.way = way));
      case Kind.decision:
        return this.keep(items.readDecision(protocol.readJson(payload), low, time), (d) => this.decide(d));
      case Kind.depth:
        return this.keep(protocol.readDepth(payload, asSigned(high), asSigned(low)), (item) =>
          this.depth.set(`${high},${low}`, { revision: ++this.stamp, item }),
        );
      case Kind.voxels:
        return this.keep(protocol.readVoxels(payload), (item) =>
          this.voxels.set(`${high},${low}`, { revision: ++this.stamp, item }),
        );
      case Kind.cubes:
        return this.keep(protocol.readVoxels(payload), (item) =>
          this.cubes.set(`${high},${low}`, { revision: ++this.stamp, item }),
        );
      case Kind.sphere:
        return this.keep(protocol.readSphere(payload), (sphere) => (this.sphere = sphere));
      case Kind.sounds:
        return this.keep(readSounds(protocol.readJson(payload)), (sounds) => (this.sounds = sounds));
      case Kind.levels:
        return this.keep(readLevels(protocol.readJson(payload)), (levels) => (this.levels = levels));
      case Kind.partner:
        return this.keep(readPartner(protocol.readJson(payload), time), (partner) => this.partners.set(low, partner));
      case Kind.health:
        return this.keep(items.readHealth(protocol.readJson(payload)), (health) => (this.health = health));
      case Kind.times:
        return this.keep(items.readTimes(protocol.readJson(payload)), (times) => (this.times = times));
      case Kind.clock:
        return this.keep(items.readClock(protocol.readJson(payload)), (clock) => (this.clock = clock));
      case Kind.refusal:
        return this.keep(items.readRefusal(protocol.readJson(payload)), (refusal) => (this.refusal = refusal));
      case Kind.preview:
        return this.keep(readPreview(protocol.readJson(payload)), (preview) => (this.preview = preview));
      case Kind.signals:
        return this.signals.take(low, payload);
      case Kind.packed:
        return false;
    }
  }

  private keep<T>(item: T | null, set: (item: T) => void): boolean {
    if (item === null) return false;
    set(item);
    return true;
  }

  private hear(sonar: number, waiting: Waiting): boolean {
    const image = this.sonars.get(sonar);
    if (!image) {
      const queue = this.waiting.get(sonar) ?? [];
      if (queue.length >= kMostWaiting || this.waiting.size > 16) return false;
      queue.push(waiting);
      this.waiting.set(sonar, queue);
      return true;
    }
    const echoes = protocol.readEchoes(waiting.payload, waiting.low);
    if (!echoes || !image.take(echoes, waiting.time)) return false;
    this.trail.take(image.sonar, echoes, waiting.time);
    return true;
  }

  private decide(decision: items.Decision): void {
    const last = this.decisions.at(-1);
    if (!last || last.number < decision.number) {
      this.decisions.push(decision);
    } else {
      const at = this.decisions.findIndex((d) => d.number >= decision.number);
      this.decisions.splice(at, this.decisions[at]!.number === decision.number ? 1 : 0, decision);
    }
    if (this.decisions.length > kMostDecisions) this.decisions.splice(0, this.decisions.length - kMostDecisions);
  }

  private remove({ kind, high, low }: protocol.RecordView): boolean {
    switch (kind) {
      case Kind.scene:
        this.scene = null;
        break;
      case Kind.vehicle:
        this.vehicle = null;
        break;
      case Kind.track:
        this.track.delete(low);
        break;
      case Kind.sonar:
        this.sonars.delete(low);
        break;
      case Kind.echoes:
        this.sonars.get(high)?.clear(low);
        break;
      case Kind.grid:
        this.grid = null;
        break;
      case Kind.obstacles:
        this.obstacles = [];
        this.pieces = [];
        break;
      case Kind.way:
        this.way = null;
        break;
      case Kind.decision:
        this.decisions = this.decisions.filter((d) => d.number !== low);
        break;
      case Kind.depth:
        this.depth.delete(`${high},${low}`);
        break;
      case Kind.voxels:
        this.voxels.delete(`${high},${low}`);
        break;
      case Kind.cubes:
        this.cubes.delete(`${high},${low}`);
        break;
      case Kind.sphere:
        this.sphere = null;
        break;
      case Kind.sounds:
        this.sounds = [];
        break;
      case Kind.levels:
        this.levels = [];
        break;
      case Kind.partner:
        this.partners.delete(low);
        break;
      case Kind.health:
        this.health = null;
        break;
      case Kind.times:
        this.times = [];
        break;
      case Kind.clock:
        this.clock = null;
        break;
      case Kind.refusal:
        this.refusal = null;
        break;
      case Kind.preview:
        this.preview = null;
        break;
      case Kind.signals: // later than the shown moment, which a plot shows, too
        break;
      case Kind.packed:
        return false;
    }
    return true;
  }
}

function kindName(kind: Kind): string {
  return Object.entries(Kind).find(([, value]) => value === kind)?.[0] ?? `kind ${kind}`;
}
