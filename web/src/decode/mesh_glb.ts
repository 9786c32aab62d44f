// SPDX-License-Identifier: Apache-2.0
// Reads the GLB of a mesh frame: one node per tile (server/wire/README.md), and only the parts of
// glTF that the server writes.

type Numbers =
  | Int8Array<ArrayBuffer>
  | Uint8Array<ArrayBuffer>
  | Int16Array<ArrayBuffer>
  | Uint16Array<ArrayBuffer>
  | Uint32Array<ArrayBuffer>
  | Float32Array<ArrayBuffer>;

/** Decompresses a buffer view, as MeshoptDecoder does. */
export interface BufferDecoder {
  decodeGltfBuffer(
    target: Uint8Array,
    count: number,
    size: number,
    source: Uint8Array,
    mode: string,
    filter?: string,
  ): void;
}

/** Three values of each vertex, every `stride` values, as integers that may stand for -1 to 1. */
export interface VertexValues {
  array: Numbers;
  stride: number;
  isNormalized: boolean;
}

/** The triangles of one or more tiles. */
export interface TileShape {
  positions: VertexValues;
  /** The fourth value of each is 1 where the surface is that of the untouched stock, else 0. */
  normals: VertexValues;
  index: Uint16Array<ArrayBuffer> | Uint32Array<ArrayBuffer>;
}

type Triple = [x: number, y: number, z: number];

/** A tile, or a rectangle of tiles that differ in their places only, from x, y up. */
export interface TileNode {
  x: number;
  y: number;
  columns: number;
  rows: number;
  version: number;
  /** Level of detail; 0 is exact. */
  level: number;
  /** Of its columns; missing: the server does not state it. */
  digest?: string;
  /** In the frame's shapes; null: no material is left in the tile. */
  shape: number | null;
  /** A position times the scale, plus the translation, is in millimeters. */
  scale: Triple;
  translation: Triple;
}

export interface MeshFrame {
  /** Motions of the block that are in it. */
  motions: number;
  nodes: TileNode[];
  shapes: TileShape[];
}

// The parts of glTF 2.0 that are used.
interface View {
  byteOffset?: number;
  byteLength: number;
  byteStride?: number;
  extensions?: { EXT_meshopt_compression?: Compressed };
}
interface Compressed {
  byteOffset?: number;
  byteLength: number;
  byteStride: number;
  count: number;
  mode: string;
  filter?: string;
}
interface Accessor {
  bufferView: number;
  byteOffset?: number;
  componentType: number;
  count: number;
  normalized?: boolean;
}
interface Node {
  name?: string;
  mesh?: number;
  translation?: Triple;
  scale?: Triple;
  extras?: Record<string, unknown>;
}
interface Gltf {
  scenes: { nodes?: number[]; extras?: Record<string, unknown> }[];
  nodes?: Node[];
  meshes?: { primitives: { attributes: Record<string, number>; indices: number }[] }[];
  accessors?: Accessor[];
  bufferViews?: View[];
}

const MAGIC = 0x46546c67;
const HEADER_BYTES = 12;
const CHUNK_HEADER_BYTES = 8;
type ValuesOf = (new (buffer: ArrayBuffer) => Numbers) & { BYTES_PER_ELEMENT: number };
const ARRAYS = new Map<number, ValuesOf>([
  [5120, Int8Array],
  [5121, Uint8Array],
  [5122, Int16Array],
  [5123, Uint16Array],
  [5125, Uint32Array],
  [5126, Float32Array],
]);

/** The JSON and the bytes of a GLB. */
function partsOf(glb: Uint8Array): { gltf: Gltf; binary: Uint8Array } {
  const head = new DataView(glb.buffer, glb.byteOffset, glb.byteLength);
  if (glb.length < HEADER_BYTES + CHUNK_HEADER_BYTES || head.getUint32(0, true) !== MAGIC)
    throw new Error('it is not a GLB');
  const jsonAt = HEADER_BYTES + CHUNK_HEADER_BYTES;
  const jsonBytes = head.getUint32(HEADER_BYTES, true);
  const json = new TextDecoder().decode(glb.subarray(jsonAt, jsonAt + jsonBytes));
  const binary = glb.subarray(jsonAt + jsonBytes + CHUNK_HEADER_BYTES);
  return { gltf: JSON.parse(json) as Gltf, binary };
}

class Reader {
  readonly shapes: TileShape[] = [];
  private readonly shapeOf_ = new Map<number, number>(); // by mesh
  private readonly views_ = new Map<number, Uint8Array>();

  constructor(
    private readonly gltf: Gltf,
    private readonly binary: Uint8Array,
    private readonly decoder: BufferDecoder,
  ) {}

  node(node: Node): TileNode {
    const { tile, version, level = 0, repeat = [1, 1], digest } = node.extras ?? {};
    const isTile = isPair(tile) && isPair(repeat);
    if (!isTile || typeof version !== 'number' || typeof level !== 'number')
      throw new Error(`node "${node.name}" has no valid tile, version or level`);
    return {
      x: tile[0],
      y: tile[1],
      columns: repeat[0],
      rows: repeat[1],
      version,
      level,
      ...(typeof digest === 'string' ? { digest } : {}),
      shape: node.mesh === undefined ? null : this.shape_(node.mesh),
      scale: node.scale ?? [1, 1, 1],
      translation: node.translation ?? [0, 0, 0],
    };
  }

  private shape_(mesh: number): number {
    const known = this.shapeOf_.get(mesh);
    if (known !== undefined) return known;
    const { attributes, indices } = this.gltf.meshes![mesh]!.primitives[0]!;
    const positions = this.vertices_(attributes['POSITION']!);
    const normals = this.vertices_(attributes['NORMAL']!);
    const { array: index } = this.values_(indices, 1);
    if (!(index instanceof Uint16Array || index instanceof Uint32Array))
      throw new Error('indices must have 16 or 32 bits');
    this.shapes.push({ positions, normals, index });
    this.shapeOf_.set(mesh, this.shapes.length - 1);
    return this.shapes.length - 1;
  }

  private vertices_(accessor: number): VertexValues {
    return this.values_(accessor, 3);
  }

  /** A copy of an accessor's values, with the bytes between them. */
  private values_(number: number, values: number): VertexValues {
    const {
      bufferView,
      byteOffset = 0,
      componentType,
      count,
      normalized,
    } = this.gltf.accessors![number]!;
    const Values = ARRAYS.get(componentType);
    if (!Values) throw new Error(`component type ${componentType} is unknown`);
    const { byteStride = values * Values.BYTES_PER_ELEMENT } = this.gltf.bufferViews![bufferView]!;
    const view = this.view_(bufferView);
    const bytes = new Uint8Array(count * byteStride);
    if (byteOffset + bytes.length > view.length)
      throw new Error(`accessor ${number} ends behind its buffer view`);
    bytes.set(view.subarray(byteOffset, byteOffset + bytes.length));
    return {
      array: new Values(bytes.buffer),
      stride: byteStride / Values.BYTES_PER_ELEMENT,
      isNormalized: normalized === true,
    };
  }

  private view_(number: number): Uint8Array {
    let bytes = this.views_.get(number);
    if (!bytes) {
      const view = this.gltf.bufferViews![number]!;
      const compressed = view.extensions?.EXT_meshopt_compression;
      bytes = compressed ? this.decompressed_(compressed) : this.part_(view);
      this.views_.set(number, bytes);
    }
    return bytes;
  }

  private decompressed_(view: Compressed): Uint8Array {
    const { byteStride, count, mode, filter } = view;
    const bytes = new Uint8Array(count * byteStride);
    this.decoder.decodeGltfBuffer(bytes, count, byteStride, this.part_(view), mode, filter);
    return bytes;
  }

  private part_({ byteOffset = 0, byteLength }: View | Compressed): Uint8Array {
    return this.binary.subarray(byteOffset, byteOffset + byteLength);
  }
}

function isPair(value: unknown): value is [number, number] {
  return Array.isArray(value) && value.length === 2 && value.every(Number.isInteger);
}

/** Throws an error with a reason if the bytes are not such a GLB. */
export function readMeshGlb(glb: Uint8Array, decoder: BufferDecoder): MeshFrame {
  const { gltf, binary } = partsOf(glb);
  const { nodes = [], extras = {} } = gltf.scenes[0]!;
  const reader = new Reader(gltf, binary, decoder);
  const { to } = extras;
  return {
    motions: typeof to === 'number' ? to : 0,
    nodes: nodes.map((node) => reader.node(gltf.nodes![node]!)),
    shapes: reader.shapes,
  };
}
