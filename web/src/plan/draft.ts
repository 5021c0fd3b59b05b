/**
 * Draft: a mission that the operator edits on the chart, made from the mission of the vehicle. Every change can be undone.
 * The program checks it and plans its way; the page only edits.
 */
import type { Scene } from '../items';
import type { Point } from '../protocol';

/** As many as the program takes (docs/live-page.md). */
export const kMostPoints = 100;
const kMostUndo = 200;

export interface DraftPoint {
  at: Point;
  name: string;
  /** Index of the mission's point of which it keeps all that is not edited here. */
  from: number | undefined;
  depth: number;
  /** m above the bottom, instead of the depth. */
  altitude: number | undefined;
  /** m/s; 0: that of the mission. */
  speed: number;
}
interface State {
  points: readonly DraftPoint[];
  fence: readonly Point[];
}

/** The draft in a request. */
export interface DraftJson {
  mission: number;
  points: Record<string, number>[];
  fence?: [number, number][];
}

const tidy = (value: number): number => Math.round(value * 100) / 100;

export class Draft {
  /** Grows with each change. */
  revision = 1;
  readonly mission: number;
  private state: State;
  private readonly begun: readonly Point[];
  private readonly past: State[] = [];

  /** Without points of the mission, the draft begins empty, as that of a single place does. */
  constructor(
    scene: Scene,
    withPoints: boolean,
    private readonly depth: number,
  ) {
    this.mission = scene.missionNumber;
    this.begun = scene.fence;
    const points = scene.mission.map(
      ({ at, name, depth: below, altitude, speed }, from): DraftPoint => ({
        at,
        name,
        from,
        depth: below ?? depth,
        altitude,
        speed: speed ?? 0,
      }),
    );
    this.state = { points: withPoints ? points : [], fence: scene.fence };
    const last = points.at(-1);
    if (!withPoints && last) this.like = { depth: last.depth, altitude: last.altitude };
  }
  private like: { depth: number; altitude: number | undefined } | undefined;

  get points(): readonly DraftPoint[] {
    return this.state.points;
  }
  get fence(): readonly Point[] {
    return this.state.fence;
  }
  get canUndo(): boolean {
    return this.past.length > 0;
  }

  /** A new point has the depth of the last one. Returns its index; -1: there are as many as may be. */
  add(at: Point): number {
    const { points } = this.state;
    if (points.length >= kMostPoints) return -1;
    const { depth, altitude } = points.at(-1) ?? this.like ?? { depth: this.depth, altitude: undefined };
    this.change({ points: [...points, { at, name: '', from: undefined, depth, altitude, speed: 0 }] });
    return points.length;
  }
  set(index: number, part: Partial<DraftPoint>): void {
    this.change({ points: this.state.points.map((p, i) => (i === index ? { ...p, ...part } : p)) });
  }
  remove(index: number): void {
    this.change({ points: this.state.points.filter((_, i) => i !== index) });
  }

  /** A new corner stands between the two ends of the nearest side. Returns its index; -1: there are as many as may be. */
  addCorner(at: Point): number {
    const { fence } = this.state;
    if (fence.length >= kMostPoints) return -1;
    let index = fence.length;
    let nearest = Infinity;
    if (fence.length > 2) {
      fence.forEach((a, i) => {
        const far = sideDistance(at, a, fence[(i + 1) % fence.length]!);
        if (far < nearest) [nearest, index] = [far, i + 1];
      });
    }
    this.change({ fence: [...fence.slice(0, index), at, ...fence.slice(index)] });
    return index;
  }
  setCorner(index: number, at: Point): void {
    this.change({ fence: this.state.fence.map((p, i) => (i === index ? at : p)) });
  }
  removeCorner(index: number): void {
    this.change({ fence: this.state.fence.filter((_, i) => i !== index) });
  }

  /** Changes until `drop` count as one for undo. */
  lift(): void {
    this.remember();
    this.lifted = true;
  }
  drop(): void {
    this.lifted = false;
    if (this.past.at(-1) === this.state) this.past.pop();
  }
  private lifted = false;

  undo(): void {
    const before = this.past.pop();
    if (!before) return;
    this.state = before;
    ++this.revision;
  }

  json(): DraftJson {
    const json: DraftJson = {
      mission: this.mission,
      points: this.points.map(({ at, from, depth, altitude, speed }) => ({
        north: tidy(at[0]),
        east: tidy(at[1]),
        ...(altitude === undefined ? { depth_m: tidy(depth) } : { altitude_m: tidy(altitude) }),
        ...(speed > 0 ? { speed: tidy(speed) } : {}),
        ...(from === undefined ? {} : { from }),
      })),
    };
    if (this.fence !== this.begun) json.fence = this.fence.map(([n, e]) => [tidy(n), tidy(e)]);
    return json;
  }

  private remember(): void {
    this.past.push(this.state);
    if (this.past.length > kMostUndo) this.past.shift();
  }
  private change(part: Partial<State>): void {
    if (!this.lifted) this.remember();
    this.state = { ...this.state, ...part };
    ++this.revision;
  }
}

/** From a place to a side of the fence, m. */
function sideDistance([n, e]: Point, [an, ae]: Point, [bn, be]: Point): number {
  const [dn, de] = [bn - an, be - ae];
  const along = Math.min(1, Math.max(0, ((n - an) * dn + (e - ae) * de) / Math.max(1e-9, dn * dn + de * de)));
  return Math.hypot(n - an - along * dn, e - ae - along * de);
}
