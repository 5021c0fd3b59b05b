/**
 * VoxelMesh: the voxels as cubes of one mesh. Only the three sides of a cube that face the eye are drawn: one corner
 * with three sides, mirrored towards the eye. The shader reads positions and colours from textures by the number of the
 * vertex. Instancing would cost four times as much in software rendering, which draws one instance at a time.
 */
import {
  BufferGeometry,
  DataTexture,
  DoubleSide,
  FloatType,
  Mesh,
  RGBAFormat,
  ShaderMaterial,
  UnsignedByteType,
  Vector3,
} from 'three';
import { rgbOf, tables } from '../colours';
import type { Model } from '../model';
import type { Theme } from '../theme';
import { lightUniforms, shadeInVertex, shadedFragment } from './shading';
import { kCell, VoxelShell } from './voxel_shell';

export type VoxelColour = 'depth' | 'probability';
/** Texels per row. */
const kRow = 1024;
/** Vertices per cube: three sides of two triangles each. */
const kVertices = 18;
/** Drawn share of an edge; the rest separates the cubes. */
const kDrawn = 0.96;

export class VoxelMesh {
  readonly mesh: Mesh<BufferGeometry, ShaderMaterial>;
  colour: VoxelColour = 'depth';
  /** Most cubes to draw: more than that neither fits a screen nor is drawn by a laptop in time. */
  most = 300_000;
  shown = 0;
  /** Voxels along an edge of a cube. */
  get side(): number {
    return this.shell.side;
  }
  /** Depths at the ends of the colour scale, m. */
  range: [number, number] = [0, 1];
  private readonly shell = new VoxelShell();
  private places = texture(new Float32Array(4 * kRow), 1);
  private tints = texture(new Uint8Array(4 * kRow), 1);

  constructor() {
    const material = new ShaderMaterial({
      uniforms: {
        ...lightUniforms(),
        eye: { value: new Vector3() },
        places: { value: this.places },
        tints: { value: this.tints },
      },
      vertexShader: kVertex,
      fragmentShader: shadedFragment,
      side: DoubleSide, // mirroring a corner reverses its winding
    });
    this.mesh = new Mesh(new BufferGeometry(), material);
    this.mesh.geometry.setDrawRange(0, 0);
    this.mesh.frustumCulled = false;
    this.mesh.onBeforeRender = (_renderer, _scene, camera) => {
      this.mesh.worldToLocal(material.uniforms['eye']!.value.setFromMatrixPosition(camera.matrixWorld));
    };
  }

  build(model: Model, theme: Theme): void {
    const pieces = this.shell.of(model, this.most);
    const count = pieces.reduce((sum, cells) => sum + cells.length / kCell, 0);
    this.reserve(count);
    this.range = rangeOf(pieces);
    const [low, high] = this.range;
    const places = this.places.image.data as Float32Array;
    const tints = this.tints.image.data as Uint8Array;
    const table = theme.name === 'night' ? tables.ember : tables.viridis;
    let i = 0;
    for (const cells of pieces) {
      for (let at = 0; at < cells.length; at += kCell, ++i) {
        const down = cells[at + 2]!;
        places[4 * i] = cells[at + 1]!;
        places[4 * i + 1] = cells[at]!;
        places[4 * i + 2] = -down;
        places[4 * i + 3] = kDrawn * cells[at + 4]!;
        // Shallow is light, because a keel meets it first. High probability is light too.
        const share = this.colour === 'depth' ? 1 - (down - low) / (high - low) : (cells[at + 3]! - 0.5) * 2;
        const word = table[Math.min(255, Math.max(0, Math.round(30 + 225 * share)))]!;
        [tints[4 * i], tints[4 * i + 1], tints[4 * i + 2]] = rgbOf(word);
      }
    }
    this.places.needsUpdate = this.tints.needsUpdate = true;
    this.mesh.geometry.setDrawRange(0, kVertices * count);
    this.shown = count;
  }

  private reserve(count: number): void {
    if (count <= kRow * this.places.image.height) return;
    this.places.dispose();
    this.tints.dispose();
    const rows = Math.ceil((1.5 * count) / kRow);
    const { uniforms } = this.mesh.material;
    uniforms['places']!.value = this.places = texture(new Float32Array(4 * kRow * rows), rows);
    uniforms['tints']!.value = this.tints = texture(new Uint8Array(4 * kRow * rows), rows);
  }
}

function texture(data: Float32Array | Uint8Array, rows: number): DataTexture {
  const type = data instanceof Float32Array ? FloatType : UnsignedByteType;
  return new DataTexture(data, kRow, rows, RGBAFormat, type);
}

const kVertex = `
uniform vec3 eye;
uniform highp sampler2D places;
uniform sampler2D tints;
${shadeInVertex}
const int kOrder[6] = int[6](0, 1, 2, 1, 3, 2);
void main() {
  int cube = gl_VertexID / ${kVertices};
  int vertex = gl_VertexID - ${kVertices} * cube;
  ivec2 texel = ivec2(cube & ${kRow - 1}, cube / ${kRow});
  vec4 place = texelFetch(places, texel, 0);
  vec3 turned = mix(vec3(-1.0), vec3(1.0), step(place.xyz, eye));
  int side = vertex / 6;
  int end = kOrder[vertex - 6 * side];
  vec2 across = vec2(end & 1, end >> 1) - 0.5;
  vec3 corner = side == 0 ? vec3(0.5, across) : side == 1 ? vec3(across.y, 0.5, across.x) : vec3(across, 0.5);
  vec3 outward = vec3(side == 0, side == 1, side == 2);
  shade(texelFetch(tints, texel, 0).rgb, outward * turned);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(place.xyz + corner * turned * place.w, 1.0);
}`;

function rangeOf(pieces: readonly Float32Array[]): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (const cells of pieces) {
    for (let at = 2; at < cells.length; at += kCell) {
      low = Math.min(low, cells[at]!);
      high = Math.max(high, cells[at]!);
    }
  }
  return low < high ? [low, high] : [0, 1];
}
