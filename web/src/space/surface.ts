/** The depth map as a surface: a mesh a tile, made again when its tile, the scale or the theme has changed. */
import { BufferAttribute, BufferGeometry, DoubleSide, Group, Mesh, MeshLambertMaterial } from 'three';
import type { Model } from '../model';
import type { DepthTile } from '../protocol';
import type { Theme } from '../theme';
import { put } from './frame';

/** Points a side of a tile: finer is not seen. */
const kMostSide = 128;

interface Tile {
  revision: number;
  look: string;
  mesh: Mesh<BufferGeometry>;
}

export class Surface {
  readonly group = new Group();
  private readonly tiles = new Map<string, Tile>();
  private readonly material = new MeshLambertMaterial({ vertexColors: true, side: DoubleSide, transparent: true, opacity: 0.92 });

  /** At most `most` tiles at a time, so that a frame stays a frame. True: there is more to do. */
  build(model: Model, theme: Theme, deepest: number, most = 6): boolean {
    const look = `${theme.name} ${deepest}`;
    for (const [key, { mesh }] of this.tiles) {
      if (model.depth.has(key)) continue;
      this.group.remove(mesh);
      mesh.geometry.dispose();
      this.tiles.delete(key);
    }
    let made = 0;
    for (const [key, { item, revision }] of model.depth) {
      const known = this.tiles.get(key);
      if (known?.revision === revision && known.look === look) continue;
      if (made++ >= most) return true;
      const geometry = shape(item, theme, deepest);
      if (known) {
        known.mesh.geometry.dispose();
        known.mesh.geometry = geometry;
        Object.assign(known, { revision, look });
      } else {
        const mesh = new Mesh(geometry, this.material);
        this.group.add(mesh);
        this.tiles.set(key, { revision, look, mesh });
      }
    }
    return false;
  }
}

function shape(tile: DepthTile, theme: Theme, deepest: number): BufferGeometry {
  const step = Math.max(1, Math.ceil(tile.side / kMostSide));
  const side = Math.ceil(tile.side / step);
  const places = new Float32Array(3 * side * side);
  const colours = new Uint8Array(3 * side * side);
  const known = new Uint8Array(side * side);
  const table = theme.paint.depth;
  for (let row = 0; row < side; ++row) {
    for (let column = 0; column < side; ++column) {
      const i = row * side + column;
      const from = row * step * tile.side + column * step;
      const depth = tile.depth[from]!;
      known[i] = Number.isNaN(depth) ? 0 : 1;
      const [north, east] = [tile.north + (row * step + 0.5) * tile.pixel, tile.east + (column * step + 0.5) * tile.pixel];
      put(places, i, north, east, known[i] ? depth : 0);
      const word = table[Math.min(255, Math.round((255 * (known[i] ? depth : 0)) / deepest))]!;
      // Less sure is greyer.
      const sure = 0.45 + 0.55 * Math.sqrt(Math.min(1, tile.confidence[from]! / 20));
      const grey = theme.name === 'day' ? 190 : 40;
      for (let k = 0; k < 3; ++k) colours[3 * i + k] = sure * ((word >> (8 * k)) & 255) + (1 - sure) * grey;
    }
  }
  const corners: number[] = [];
  for (let row = 0; row + 1 < side; ++row) {
    for (let column = 0; column + 1 < side; ++column) {
      const [a, b, c, d] = [row * side + column, row * side + column + 1, (row + 1) * side + column, (row + 1) * side + column + 1];
      if (known[a] && known[b] && known[c]) corners.push(a, b, c);
      if (known[b] && known[d] && known[c]) corners.push(b, d, c);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(places, 3));
  geometry.setAttribute('color', new BufferAttribute(colours, 3, true));
  geometry.setIndex(corners);
  geometry.computeVertexNormals();
  return geometry;
}
