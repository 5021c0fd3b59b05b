/** The depth map as a surface: a mesh a tile, made again when its tile, the scale or the theme has changed. */
import { BufferAttribute, BufferGeometry, DoubleSide, Group, Mesh, ShaderMaterial } from 'three';
import type { Model, Revised } from '../model';
import type { DepthTile } from '../protocol';
import type { Theme } from '../theme';
import { put } from './frame';
import { lightUniforms, shadedFragment, shadeInVertex } from './shading';

/** Points a side of a tile: finer is not seen, coarser says nothing. */
const [kMostSide, kLeastSide] = [128, 8];
/** ms a frame for tiles. */
const kBuilds = 40;

const kVertex = `
attribute vec3 tint;
${shadeInVertex}
void main() {
  shade(tint, normal);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

interface Tile {
  revision: number;
  look: string;
  mesh: Mesh<BufferGeometry>;
}

export class Surface {
  readonly group = new Group();
  /** Points of all tiles together, about. */
  most = 600_000;
  private readonly tiles = new Map<string, Tile>();
  private readonly material = new ShaderMaterial({
    uniforms: lightUniforms(0.92),
    vertexShader: kVertex,
    fragmentShader: shadedFragment,
    side: DoubleSide,
    forceSinglePass: true,
    transparent: true,
  });

  /** As many tiles as a frame has time for, so that it stays a frame. True: there is more to do. */
  build(model: Model, theme: Theme, deepest: number): boolean {
    const until = performance.now() + kBuilds;
    // By powers of two, or each new tile would make all others again.
    const share = 2 ** Math.floor(Math.log2(Math.sqrt(this.most / Math.max(1, model.depth.size))));
    const finest = Math.min(kMostSide, Math.max(kLeastSide, share));
    const look = `${theme.name} ${deepest} ${finest}`;
    for (const [key, { mesh }] of this.tiles) {
      if (model.depth.has(key)) continue;
      this.group.remove(mesh);
      mesh.geometry.dispose();
      this.tiles.delete(key);
    }
    for (const [key, { item, revision }] of model.depth) {
      const known = this.tiles.get(key);
      const beside = neighbours(model, item);
      const joined = `${look} ${beside.map((tile) => tile?.revision ?? 0).join()}`;
      if (known?.revision === revision && known.look === joined) continue;
      if (performance.now() > until) return true;
      const geometry = shape(
        item,
        beside.map((tile) => tile?.item),
        theme,
        deepest,
        finest,
      );
      if (known) {
        known.mesh.geometry.dispose();
        known.mesh.geometry = geometry;
        Object.assign(known, { revision, look: joined });
      } else {
        const mesh = new Mesh(geometry, this.material);
        this.group.add(mesh);
        this.tiles.set(key, { revision, look: joined, mesh });
      }
    }
    return false;
  }
}

/** To the north, the east and the north-east: the surface goes on to their first points, so that no gap is left. */
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
): BufferGeometry {
  const step = Math.max(1, Math.ceil(tile.side / finest));
  const side = Math.ceil(tile.side / step) + 1;
  const places = new Float32Array(3 * side * side);
  const colours = new Uint8Array(3 * side * side);
  const known = new Uint8Array(side * side);
  const table = theme.paint.depth;
  const grey = theme.name === 'day' ? 190 : 40;
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
      const word = table[Math.min(255, Math.max(0, Math.round((255 * depth) / deepest)))]!;
      // Less sure is greyer.
      const sure = 0.45 + 0.55 * Math.sqrt(Math.min(1, from.confidence[at]! / 20));
      for (let k = 0; k < 3; ++k)
        colours[3 * i + k] = Math.round(sure * ((word >> (8 * k)) & 255) + (1 - sure) * grey);
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
  geometry.setAttribute('tint', new BufferAttribute(colours, 3, true));
  geometry.setIndex(corners);
  geometry.computeVertexNormals();
  return geometry;
}
