/**
 * Standing: what bounds the way of the vehicle in the 3-D view. Fence, keep-out areas and obstacles are known in plan;
 * the planner takes them to stand through all the water, so they are walls from the surface to the deepest depth shown.
 */
import {
  DoubleSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
} from 'three';
import type { Model } from '../model';
import type { Point } from '../protocol';
import type { Paint } from '../theme';
import { geometryOf, put } from './frame';
import { clear } from './labels';

interface Wall {
  outline: readonly Point[];
  colour: string;
  opacity: number;
}

/** Opacities: a fence far away must not hide what is within it. */
const [kFence, kKeepOut, kSeen, kRemembered] = [0.06, 0.14, 0.45, 0.15];

export class Standing {
  readonly group = new Group();
  /** Obstacles that are drawn. */
  obstacles = 0;
  private look = '';

  /** `revision`: grows when the fence or the obstacles of the model have changed. */
  show(model: Model, revision: string, shows: { fence: boolean; obstacles: boolean }, deepest: number, paint: Paint): void {
    const look = [revision, shows.fence, shows.obstacles, deepest, paint.fence, paint.obstacle].join();
    if (look === this.look) return;
    this.look = look;
    clear(this.group);
    const { scene, pieces } = model;
    const walls: Wall[] = [];
    if (scene && shows.fence) {
      if (scene.fence.length > 2) walls.push({ outline: scene.fence, colour: paint.fence, opacity: kFence });
      for (const outline of scene.keepOut) walls.push({ outline, colour: paint.fence, opacity: kKeepOut });
    }
    const drawn = shows.obstacles ? pieces.filter(({ outline }) => outline.length > 1) : [];
    for (const { outline, id, behind } of drawn) {
      const colour = behind ? paint.behind : paint.obstacle;
      walls.push({ outline, colour, opacity: id === undefined ? kSeen : kRemembered });
    }
    this.obstacles = new Set(drawn.map(({ number }) => number)).size;
    const kinds = new Map<string, Wall[]>();
    for (const wall of walls) {
      const kind = `${wall.colour} ${wall.opacity}`;
      kinds.set(kind, [...(kinds.get(kind) ?? []), wall]);
    }
    for (const alike of kinds.values()) this.group.add(...meshOf(alike, deepest));
  }
}

/** The faces of walls of one colour, and their edges. */
function meshOf(walls: readonly Wall[], deepest: number): [Mesh, LineSegments] {
  const sides = walls.reduce((sum, { outline }) => sum + outline.length, 0);
  const faces = new Float32Array(18 * sides);
  const edges = new Float32Array(18 * sides);
  let at = 0;
  for (const { outline } of walls) {
    outline.forEach(([n, e], i) => {
      const [m, f] = outline[(i + 1) % outline.length]!;
      const [top, nextTop] = [[n, e, 0], [m, f, 0]] as const;
      const [foot, nextFoot] = [[n, e, deepest], [m, f, deepest]] as const;
      [top, nextTop, nextFoot, top, nextFoot, foot].forEach(([x, y, z], k) => put(faces, at + k, x, y, z));
      [top, nextTop, foot, nextFoot, top, foot].forEach(([x, y, z], k) => put(edges, at + k, x, y, z));
      at += 6;
    });
  }
  const { colour: color, opacity } = walls[0]!;
  const pale = new MeshBasicMaterial({ color, opacity, transparent: true, side: DoubleSide, depthWrite: false });
  const edge = new LineBasicMaterial({ color, opacity: Math.min(1, 0.3 + opacity), transparent: true });
  return [new Mesh(geometryOf(faces), pale), new LineSegments(geometryOf(edges), edge)];
}

