/**
 * Surface: the depth map as a surface. The piece of a tile is rebuilt when the tile, the scale or the theme has
 * changed. Neighbouring tiles share one mesh, because hundreds of small meshes would take longer to draw than their
 * points.
 */
import { BufferAttribute, BufferGeometry, DoubleSide, Group, Mesh, ShaderMaterial } from 'three';
import type { Model, Revised } from '../model';
import type { DepthTile } from '../protocol';
import type { Theme } from '../theme';
import { put } from './frame';
import { lightUniforms, shadedFragment, shadeInVertex } from './shading';

/** Points along the side of a tile, most and least: finer is not visible, coarser shows nothing. */
const [kMostSide, kLeastSide] = [128, 8];
/** ms per frame for building tiles. */
const kBuilds = 40;

const kVertex = `
attribute vec3 tint;
${shadeInVertex}
void main() {
  shade(tint, normal);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

/** Tiles along the side of a mesh. */
const kTogether = 4;

interface Tile {
  revision: number;
  look: string;
  sheet: string;
  piece: Piece;
}
interface Piece {
  places: Float32Array;
  normals: Float32Array;
  tints: Uint8Array;
  corners: ArrayLike<number>;
}
interface Sheet {
  mesh: Mesh<BufferGeometry>;
  tiles: Set<string>;
  stale: boolean;
}

export class Surface {
  readonly group = new Group();
  /** Approximate limit of the points of all tiles together. */
  most = 600_000;
  private readonly tiles = new Map<string, Tile>();
  private readonly sheets = new Map<string, Sheet>();
  private readonly material = new ShaderMaterial({
    uniforms: lightUniforms(0.92),
    vertexShader: kVertex,
    fragmentShader: shadedFragment,
    side: DoubleSide,
    forceSinglePass: true,
    transparent: true,
  });

  /** Builds as many tiles as fit into the time of a frame. Returns whether there is more to do. */
  build(model: Model, theme: Theme, deepest: number): boolean {
    const until = performance.now() + kBuilds;
    // Powers of two, because otherwise each new tile would rebuild all others.
    const share = 2 ** Math.floor(Math.log2(Math.sqrt(this.most / Math.max(1, model.depth.size))));
    const finest = Math.min(kMostSide, Math.max(kLeastSide, share));
    const look = `${theme.name} ${deepest} ${finest}`;
    for (const [key, { sheet }] of this.tiles) {
      if (model.depth.has(key)) continue;
      const { tiles } = this.sheetOf(sheet);
      tiles.delete(key);
      this.tiles.delete(key);
    }
    let more = false;
    for (const [key, { item, revision }] of model.depth) {
      const known = this.tiles.get(key);
      const beside = neighbours(model, item);
      const joined = `${look} ${beside.map((tile) => tile?.revision ?? 0).join()}`;
      if (known?.revision === revision && known.look === joined) continue;
      if ((more = performance.now() > until)) break;
      const sheet = `${Math.floor(item.row / kTogether)},${Math.floor(item.column / kTogether)}`;
      this.sheetOf(sheet).tiles.add(key);
      const ends = beside.map((tile) => tile?.item);
      this.tiles.set(key, { revision, look: joined, sheet, piece: shape(item, ends, theme, deepest, finest) });
    }
    for (const [key, sheet] of this.sheets) {
      if (!sheet.stale) continue;
      sheet.stale = false;
      sheet.mesh.geometry.dispose();
      if (sheet.tiles.size === 0) {
        this.group.remove(sheet.mesh);
        this.sheets.delete(key);
      } else {
        sheet.mesh.geometry = joinedPieces([...sheet.tiles].map((tile) => this.tiles.get(tile)!.piece));
      }
    }
    return more;
  }

  /** The sheet of that key, marked as stale; made if it does not exist. */
  private sheetOf(key: string): Sheet {
    let sheet = this.sheets.get(key);
    if (!sheet) {
      sheet = { mesh: new Mesh(new BufferGeometry(), this.material), tiles: new Set(), stale: true };
      this.sheets.set(key, sheet);
      this.group.add(sheet.mesh);
    }
    sheet.stale = true;
    return sheet;
  }
}

function joinedPieces(pieces: readonly Piece[]): BufferGeometry {
  const points = pieces.reduce((sum, { places }) => sum + places.length / 3, 0);
  const count = pieces.reduce((sum, { corners }) => sum + corners.length, 0);
  const [places, normals] = [new Float32Array(3 * points), new Float32Array(3 * points)];
  const tints = new Uint8Array(3 * points);
  const corners = new Uint32Array(count);
  let [first, at] = [0, 0];
  for (const piece of pieces) {
    places.set(piece.places, 3 * first);
    normals.set(piece.normals, 3 * first);
    tints.set(piece.tints, 3 * first);
    for (let i = 0; i < piece.corners.length; ++i) corners[at++] = first + piece.corners[i]!;
    first += piece.places.length / 3;
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(places, 3));
  geometry.setAttribute('normal', new BufferAttribute(normals, 3));
  geometry.setAttribute('tint', new BufferAttribute(tints, 3, true));
  geometry.setIndex(new BufferAttribute(corners, 1));
  return geometry;
}

/** The tiles to the north, east and north-east: the surface extends to their first points, to leave no gap. */
function neighbours(model: Model, { row, column }: DepthTile): (Revised<DepthTile> | undefined)[] {
  const at = (r: number, c: number) => model.depth.get(`${r >>> 0},${c >>> 0}`);
  return [at(row + 1, column), at(row, column + 1), at(row + 1, column + 1)];
}

function shape(
  tile: DepthTile,
  beside: readonly (DepthTile | undefined)[],
  theme: Theme,
  deepest: number,
  finest: number,
): Piece {
  const step = Math.max(1, Math.ceil(tile.side / finest));
  const side = Math.ceil(tile.side / step) + 1;
  const places = new Float32Array(3 * side * side);
  const tints = new Uint8Array(3 * side * side);
  const known = new Uint8Array(side * side);
  const table = theme.paint.depth;
  // The last entries of a table are as dark as the background at night.
  const [darkest, grey] = theme.name === 'day' ? [230, 190] : [120, 70];
  for (let row = 0; row < side; ++row) {
    for (let column = 0; column < side; ++column) {
      const i = row * side + column;
      const [north, east] = [row === side - 1, column === side - 1];
      const from = north ? beside[east ? 2 : 0] : east ? beside[1] : tile;
      const [y, x] = [north ? 0 : row * step, east ? 0 : column * step];
      const at = y * tile.side + x;
      const depth = from?.side === tile.side ? from.depth[at]! : NaN;
      known[i] = Number.isNaN(depth) ? 0 : 1;
      if (!known[i] || !from) continue;
      put(places, i, from.north + (y + 0.5) * from.pixel, from.east + (x + 0.5) * from.pixel, depth);
      const word = table[Math.min(255, Math.max(0, Math.round((darkest * depth) / deepest)))]!;
      // Lower confidence is greyer.
      const sure = 0.45 + 0.55 * Math.sqrt(Math.min(1, from.confidence[at]! / 20));
      for (let k = 0; k < 3; ++k)
        tints[3 * i + k] = Math.round(sure * ((word >> (8 * k)) & 255) + (1 - sure) * grey);
    }
  }
  const corners: number[] = [];
  for (let row = 0; row + 1 < side; ++row) {
    for (let column = 0; column + 1 < side; ++column) {
      const [a, b, c, d] = [
        row * side + column,
        row * side + column + 1,
        (row + 1) * side + column,
        (row + 1) * side + column + 1,
      ];
      if (known[a] && known[b] && known[c]) corners.push(a, b, c);
      if (known[b] && known[d] && known[c]) corners.push(b, d, c);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(places, 3));
  geometry.setIndex(corners);
  geometry.computeVertexNormals();
  return { places, normals: geometry.getAttribute('normal').array as Float32Array, tints, corners };
}
