// SPDX-License-Identifier: Apache-2.0
// The tiles of a square of the block as one mesh, which is one draw call: without a GPU, and on
// phones, a call costs more than the few triangles of a tile. Each tile has a part of the vertices
// and of the indices, and only replaced parts go to the GPU.

import * as THREE from 'three';
import { tileAt } from '../model/tiles';
import { ORIGINAL_ATTRIBUTE } from './parsed_tiles';
import { slabOf, slabRectangles } from './slabs';
import type { Slab } from './slabs';

/** Length of new arrays relative to the need of the tiles, so that tiles may grow. */
const CAPACITY = 1.5;

/** Length of a tile's part likewise, once it has outgrown one: carved on, it grows again. */
const PART_CAPACITY = 1.25;

/** Values between two changes that are sent with them: less work than a call more. */
const NEAR = 4096;

/** An indexed shape and where it is: the matrix moves, and scales all axes alike. */
export interface PlacedShape {
  geometry: THREE.BufferGeometry;
  matrix: THREE.Matrix4;
}

/** Where a tile is in the arrays of its square. */
interface Part {
  tile: PlacedShape;
  hasGrown: boolean;
  slab: Slab | null;
  firstVertex: number;
  vertices: number; // that it may have
  firstIndex: number;
  indices: number;
}

interface Values {
  array: THREE.TypedArray;
  stride: number;
  offset: number;
  unit: number;
}

const verticesOf = ({ geometry }: PlacedShape): number => geometry.getAttribute('position').count;
const indicesOf = ({ geometry }: PlacedShape): number => geometry.index!.count;

/** The arrays of a mesh with so many vertices and indices. */
class Arrays {
  readonly geometry = new THREE.BufferGeometry();
  readonly positions: THREE.BufferAttribute;
  /** The fourth value of each is that of ORIGINAL_ATTRIBUTE. */
  readonly normals: THREE.InterleavedBuffer;
  readonly index: THREE.BufferAttribute;

  constructor(vertices: number, indices: number) {
    this.positions = new THREE.BufferAttribute(new Float32Array(3 * vertices), 3);
    this.normals = new THREE.InterleavedBuffer(new Int8Array(4 * vertices), 4);
    this.index = new THREE.BufferAttribute(new Uint32Array(indices), 1);
    for (const array of [this.positions, this.normals, this.index])
      array.setUsage(THREE.DynamicDrawUsage);
    const normal = new THREE.InterleavedBufferAttribute(this.normals, 3, 0, true);
    const original = new THREE.InterleavedBufferAttribute(this.normals, 1, 3, false);
    this.geometry.setAttribute('position', this.positions);
    this.geometry.setAttribute('normal', normal);
    this.geometry.setAttribute(ORIGINAL_ATTRIBUTE, original);
    this.geometry.setIndex(this.index);
    this.geometry.boundingBox = new THREE.Box3();
    this.geometry.boundingSphere = new THREE.Sphere();
  }
}

/** Where the values of an attribute are, and the meaning of its integers. */
function valuesOf(attribute: THREE.BufferAttribute | THREE.InterleavedBufferAttribute): Values {
  const { array, normalized } = attribute;
  const unit = normalized ? THREE.MathUtils.denormalize(1, array as Int8Array) : 1;
  return attribute instanceof THREE.InterleavedBufferAttribute
    ? { array, stride: attribute.data.stride, offset: attribute.offset, unit }
    : { array, stride: attribute.itemSize, offset: 0, unit };
}

/** These values of an array go to the GPU next. Nearby ones go in one piece. */
function changed(
  array: THREE.BufferAttribute | THREE.InterleavedBuffer,
  start: number,
  count: number,
): void {
  array.needsUpdate = true;
  const end = start + count;
  const near = array.updateRanges.find(
    (range) => start <= range.start + range.count + NEAR && range.start <= end + NEAR,
  );
  if (!near) {
    array.addUpdateRange(start, count);
    return;
  }
  const last = Math.max(near.start + near.count, end);
  near.start = Math.min(near.start, start);
  near.count = last - near.start;
}

export class TileSquare {
  readonly mesh: THREE.Mesh;
  private readonly parts_ = new Map<number, Part>();
  private arrays_ = new Arrays(0, 0);
  private usedVertices_ = 0;
  private usedIndices_ = 0;
  private slabsChanged_ = false;
  /** Whose indices are those of a rectangle of slabs. */
  private readonly merged_ = new Set<Part>();

  /** @param side number of tiles along a side of the square */
  constructor(
    material: THREE.Material,
    private readonly side: number,
  ) {
    this.mesh = new THREE.Mesh(this.arrays_.geometry, material);
    this.mesh.matrixAutoUpdate = false;
    this.mesh.castShadow = true;
    this.mesh.receiveShadow = true;
  }

  get size(): number {
    return this.parts_.size;
  }

  /** A tile as it was set. */
  get(key: number): PlacedShape | undefined {
    return this.parts_.get(key)?.tile;
  }

  tiles(): (PlacedShape & { key: number })[] {
    return [...this.parts_].map(([key, { tile }]) => ({ key, ...tile }));
  }

  /** Adds or replaces a tile. */
  set(key: number, tile: PlacedShape): void {
    const before = this.parts_.get(key);
    if (before?.slab) this.separateSlabs_();
    const isInPlace =
      before && verticesOf(tile) <= before.vertices && indicesOf(tile) <= before.indices;
    if (before && !isInPlace) this.erase_(before);
    const part = isInPlace ? { ...before, tile } : this.append_(tile, before !== undefined);
    this.parts_.set(key, part);
    if (this.fits_()) this.write_(part);
    else this.rebuild_();
    this.arrays_.geometry.setDrawRange(0, this.usedIndices_);
  }

  remove(key: number): void {
    const part = this.parts_.get(key)!;
    if (part.slab) this.separateSlabs_();
    this.erase_(part);
    this.parts_.delete(key);
  }

  /** Draws rectangles of slabs with fewer triangles from now on, until one of them changes. */
  mergeSlabs(): void {
    if (!this.slabsChanged_) return;
    this.separateSlabs_();
    this.slabsChanged_ = false;
    const slabs = new Map<number, Part>();
    for (const [key, part] of this.parts_) {
      const [x, y] = tileAt(key);
      if (part.slab) slabs.set((y % this.side) * this.side + (x % this.side), part);
    }
    const at = (x: number, y: number): Part | undefined => slabs.get(y * this.side + x);
    const slabAt = (x: number, y: number): Slab | null => at(x, y)?.slab ?? null;
    for (const { x, y, columns, rows, indices } of slabRectangles(this.side, slabAt)) {
      let used = 0;
      for (let n = 0; n < columns * rows; n += 1) {
        const part = at(x + (n % columns), y + Math.floor(n / columns))!;
        this.fillIndices_(part, indices.slice(used, used + part.indices));
        this.merged_.add(part);
        used += part.indices;
      }
    }
  }

  /** Has slabs drawn by their own triangles again. */
  private separateSlabs_(): void {
    this.slabsChanged_ = true;
    for (const part of this.merged_) this.writeIndices_(part);
    this.merged_.clear();
  }

  /** A mesh of the tiles as they are now, with vertices of its own. */
  copy(): THREE.Mesh {
    const copy = new THREE.Mesh(this.arrays_.geometry.clone(), this.mesh.material);
    copy.matrixAutoUpdate = false;
    copy.receiveShadow = true;
    return copy;
  }

  /** Takes the mesh away. */
  dispose(): void {
    this.mesh.removeFromParent();
    this.mesh.geometry.dispose();
  }

  /** A part behind all others. */
  private append_(tile: PlacedShape, hasGrown: boolean): Part {
    const factor = hasGrown ? PART_CAPACITY : 1;
    const part = {
      ...{ tile, hasGrown, slab: null },
      firstVertex: this.usedVertices_,
      vertices: Math.ceil(factor * verticesOf(tile)),
      firstIndex: this.usedIndices_,
      indices: 3 * Math.ceil((factor * indicesOf(tile)) / 3),
    };
    this.usedVertices_ += part.vertices;
    this.usedIndices_ += part.indices;
    return part;
  }

  private fits_(): boolean {
    const { positions, index } = this.arrays_;
    return this.usedVertices_ <= positions.count && this.usedIndices_ <= index.count;
  }

  /** Makes new arrays, without the gaps that tiles have left. */
  private rebuild_(): void {
    this.merged_.clear();
    this.usedVertices_ = this.usedIndices_ = 0;
    for (const [key, { tile, hasGrown }] of this.parts_)
      this.parts_.set(key, this.append_(tile, hasGrown));
    this.mesh.geometry.dispose();
    const [vertices, indices] = [this.usedVertices_, this.usedIndices_];
    this.arrays_ = new Arrays(Math.ceil(CAPACITY * vertices), Math.ceil(CAPACITY * indices));
    this.mesh.geometry = this.arrays_.geometry;
    for (const part of this.parts_.values()) this.write_(part);
  }

  private write_(part: Part): void {
    this.writePositions_(part);
    this.writeNormals_(part);
    this.writeIndices_(part);
    part.slab = this.slabOf_(part);
    if (part.slab) this.slabsChanged_ = true;
  }

  private slabOf_({ tile, firstVertex }: Part): Slab | null {
    const { positions, normals } = this.arrays_;
    const upward = (n: number): { z: number; original: number } => ({
      z: normals.array[4 * n + 2]!,
      original: normals.array[4 * n + 3]!,
    });
    return slabOf(positions.array, [firstVertex, verticesOf(tile), indicesOf(tile)], upward);
  }

  private writeIndices_(part: Part): void {
    const from = part.tile.geometry.index!.array;
    this.fillIndices_(
      part,
      Array.from(from, (vertex) => part.firstVertex + vertex),
    );
  }

  /** Triangles without area fill the rest of a part. */
  private fillIndices_({ firstIndex, indices }: Part, vertices: ArrayLike<number>): void {
    const { index } = this.arrays_;
    index.array.set(vertices, firstIndex);
    index.array.fill(0, firstIndex + vertices.length, firstIndex + indices);
    changed(index, firstIndex, indices);
  }

  private writePositions_({ tile, firstVertex }: Part): void {
    const { positions, geometry } = this.arrays_;
    const { array, stride, offset, unit } = valuesOf(tile.geometry.getAttribute('position'));
    const { elements } = tile.matrix;
    const count = verticesOf(tile);
    const { min, max } = geometry.boundingBox!;
    for (let axis = 0; axis < 3; axis += 1) {
      const [scale, move] = [unit * elements[0], elements[12 + axis]!];
      let [least, greatest] = [min.getComponent(axis), max.getComponent(axis)];
      for (let n = 0; n < count; n += 1) {
        const value = scale * array[offset + axis + n * stride]! + move;
        positions.array[3 * (firstVertex + n) + axis] = value;
        if (value < least) least = value;
        if (value > greatest) greatest = value;
      }
      min.setComponent(axis, least);
      max.setComponent(axis, greatest);
    }
    geometry.boundingBox!.getBoundingSphere(geometry.boundingSphere!);
    changed(positions, 3 * firstVertex, 3 * count);
  }

  private writeNormals_({ tile, firstVertex }: Part): void {
    const { array } = this.arrays_.normals;
    const { geometry } = tile;
    const normal = valuesOf(geometry.getAttribute('normal'));
    const original = valuesOf(geometry.getAttribute(ORIGINAL_ATTRIBUTE));
    const count = verticesOf(tile);
    for (let n = 0; n < count; n += 1) {
      const [to, from] = [4 * (firstVertex + n), normal.offset + n * normal.stride];
      for (let axis = 0; axis < 3; axis += 1)
        array[to + axis] = Math.round(127 * normal.unit * normal.array[from + axis]!);
      array[to + 3] = original.array[original.offset + n * original.stride]!;
    }
    changed(this.arrays_.normals, 4 * firstVertex, 4 * count);
  }

  private erase_(part: Part): void {
    this.fillIndices_(part, []);
  }
}
