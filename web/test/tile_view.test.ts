// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import * as THREE from 'three';
import { tileKey } from '../src/model/tiles';
import { TileView } from '../src/view/tile_view';
import { ORIGINAL_ATTRIBUTE } from '../src/view/parsed_tiles';
import type { ParsedTile } from '../src/view/parsed_tiles';
import { parsedTiles, triangle, waves } from './support/mesh_frames';
import type { TestTile } from './support/glb.mjs';

/** Displays the only tile of a frame at its place. */
function show(view: TileView, tile: ParsedTile): void {
  for (let y = tile.y; y < tile.y + tile.rows; ++y)
    for (let x = tile.x; x < tile.x + tile.columns; ++x) view.set(tile, x, y, 8);
}

function parsed(tile: TestTile): ParsedTile {
  return parsedTiles([tile])[0]!;
}

const gone = (x: number, y: number): TestTile => ({
  x,
  y,
  version: 9,
  positions: [],
  normals: [],
  indices: [],
});

function meshesOf(view: TileView): THREE.Mesh[] {
  const isMesh = (child: THREE.Object3D): child is THREE.Mesh => child instanceof THREE.Mesh;
  return view.group.children.filter(isMesh);
}

const textOf = (place: number[]): string =>
  place.map((value) => Number(value.toFixed(3)) + 0).join(' ');

/** What is drawn: the corners of all triangles that have an area, by the meshes of the scene, mm. */
function drawn(view: TileView): string[] {
  const found: string[] = [];
  for (const { geometry } of meshesOf(view)) {
    const { index, drawRange } = geometry;
    const position = geometry.getAttribute('position');
    for (let n = 0; n < drawRange.count; n += 3) {
      const corners = [0, 1, 2].map((k) => index!.getX(n + k));
      if (new Set(corners).size === 1) continue;
      const places = corners.map((at) => new THREE.Vector3().fromBufferAttribute(position, at));
      found.push(places.map((place) => textOf(place.toArray())).join(', '));
    }
  }
  return found.sort();
}

/** The same by the tiles that the view says it displays. */
function displayed(view: TileView): string[] {
  const corners = view.corners();
  const found: string[] = [];
  for (let n = 0; n < corners.length; n += 9)
    found.push([0, 3, 6].map((k) => textOf(corners.slice(n + k, n + k + 3))).join(', '));
  return found.sort();
}

/** The first corner of each triangle that is drawn, x y. */
const places = (view: TileView): string[] =>
  drawn(view).map((triangle) => triangle.split(' ').slice(0, 2).join(' '));

/** 0 to count - 1 in an order without pattern, the same in every run. */
function shuffled(count: number): number[] {
  const order = Array.from({ length: count }, (_, n) => n);
  let random = 1;
  for (let n = count - 1; n > 0; --n) {
    random = (random * 48271) % 2147483647;
    const other = random % (n + 1);
    [order[n], order[other]] = [order[other]!, order[n]!];
  }
  return order;
}

/** A triangle of a tile at depth `z`. */
const at = (x: number, y: number, z: number): ParsedTile =>
  parsed(triangle(x, y, 1, [0, 0, z, 8, 0, z, 0, 8, z]));

describe('tile view', () => {
  it('draws the right tiles, in whatever order they are set, replaced and removed', () => {
    const view = new TileView(new THREE.MeshBasicMaterial());
    const small = parsed(triangle(0, 0, 1));
    const large = parsed(waves(0, 0, 2));
    const side = 40; // more than two squares in each direction
    const left = new Map<number, number>();
    const set = (n: number, tile: ParsedTile): void => {
      view.set(tile, n % side, Math.floor(n / side), 8);
      left.set(n, tile.triangles);
    };
    const check = (): void => {
      expect(drawn(view)).toEqual(displayed(view));
      expect(
        view
          .tiles()
          .map(({ key }) => key)
          .sort(),
      ).toEqual([...left.keys()].map((n) => tileKey(n % side, Math.floor(n / side))).sort());
      const triangles = [...left.values()].reduce((sum, count) => sum + count, 0);
      expect(drawn(view)).toHaveLength(triangles);
    };
    const order = shuffled(side * side);
    for (const n of order) set(n, n % 5 === 0 ? large : small);
    check();
    for (const n of order.slice(0, 400)) {
      if (n % 3 === 0) set(n, large);
      else if (n % 3 === 1) set(n, small);
      else {
        view.remove(tileKey(n % side, Math.floor(n / side)));
        left.delete(n);
      }
      if (n % 40 === 0) check();
    }
    check();
    for (const n of [...left.keys()]) view.remove(tileKey(n % side, Math.floor(n / side)));
    expect(view.group.children).toHaveLength(0);
  });

  it('draws a large block in few calls', () => {
    const view = new TileView(new THREE.MeshBasicMaterial());
    for (let n = 0; n < 63 * 63; ++n) show(view, at(n % 63, Math.floor(n / 63), -(n % 9)));
    expect(view.group.children).toHaveLength(16);
  });

  it('gives the GPU what was replaced, not the whole square', () => {
    const view = new TileView(new THREE.MeshBasicMaterial());
    const wave = parsed(waves(0, 0, 2));
    for (let n = 0; n < 256; ++n) view.set(wave, n % 16, Math.floor(n / 16), 8);
    const { geometry } = meshesOf(view)[0]!;
    const position = geometry.getAttribute('position') as THREE.BufferAttribute;
    for (const array of [position, geometry.index!]) array.clearUpdateRanges();
    const { version } = position;
    for (const x of [3, 5]) view.set(wave, x, 15, 8);
    expect(position.version).toBeGreaterThan(version);
    const sent = position.updateRanges.reduce((sum, { count }) => sum + count, 0);
    const vertices = wave.geometry!.getAttribute('position').count;
    expect(sent).toBeGreaterThanOrEqual(6 * vertices);
    expect(sent).toBeLessThan(0.1 * position.array.length);
  });

  it('keeps normals and what is of the original surface', () => {
    const view = new TileView(new THREE.MeshBasicMaterial());
    const normals = [0, 0, 1, 0, -1, 0, 1, 0, 0];
    show(view, at(1, 0, -1));
    show(view, parsed({ ...triangle(0, 0, 1), normals, original: [1, 0, 1] }));
    const { geometry } = meshesOf(view)[0]!;
    const [normal, original] = ['normal', ORIGINAL_ATTRIBUTE].map((name) =>
      geometry.getAttribute(name),
    );
    const directions = [3, 4, 5].map((n) => new THREE.Vector3().fromBufferAttribute(normal!, n));
    expect(directions.map((one) => one.toArray().map((value) => value + 0))).toEqual([
      [0, 0, 1],
      [0, -1, 0],
      [1, 0, 0],
    ]);
    expect([3, 4, 5].map((n) => original!.getX(n))).toEqual([1, 0, 1]);
  });

  it('displays within its bounds, so that nothing seen is left out', () => {
    const view = new TileView(new THREE.MeshBasicMaterial());
    for (const [x, z] of [
      [2, -1],
      [3, -7],
      [5, 3],
    ] as const)
      show(view, at(x, 0, z));
    const { geometry } = meshesOf(view)[0]!;
    const box = new THREE.Box3(new THREE.Vector3(16, 0, -7), new THREE.Vector3(48, 8, 3));
    expect(geometry.boundingBox!.containsBox(box)).toBe(true);
    const { center, radius } = geometry.boundingSphere!;
    expect(center.distanceTo(box.min)).toBeLessThanOrEqual(radius + 1e-6);
    expect(center.distanceTo(box.max)).toBeLessThanOrEqual(radius + 1e-6);
  });

  it('disposes of buffers that were replaced, and with the last tile', () => {
    const view = new TileView(new THREE.MeshBasicMaterial());
    const disposed = new Set<THREE.BufferGeometry>();
    const made = new Set<THREE.BufferGeometry>();
    for (let x = 0; x < 16; ++x) {
      show(view, at(x, 0, -1));
      const { geometry } = meshesOf(view)[0]!;
      if (made.has(geometry)) continue;
      made.add(geometry);
      geometry.addEventListener('dispose', () => disposed.add(geometry));
    }
    expect(made.size).toBeGreaterThan(1);
    expect(disposed.size).toBe(made.size - 1);
    for (let x = 0; x < 16; ++x) show(view, parsed(gone(x, 0)));
    expect(disposed.size).toBe(made.size);
    expect(view.group.children).toHaveLength(0);
  });

  it('makes few new buffers for tiles that grow with each motion', () => {
    const view = new TileView(new THREE.MeshBasicMaterial());
    const corner = (n: number): number[] => [n % 8, Math.floor(n / 8), -1];
    const strip = (x: number, y: number, triangles: number): ParsedTile =>
      parsed({
        ...triangle(x, y, 1),
        positions: Array.from({ length: triangles + 2 }, (_, n) => corner(n)).flat(),
        normals: Array.from({ length: triangles + 2 }, () => [0, 0, 1]).flat(),
        indices: Array.from({ length: triangles }, (_, n) => [n, n + 1, n + 2]).flat(),
      });
    const made = new Set<THREE.BufferGeometry>();
    for (let triangles = 20; triangles < 60; ++triangles) {
      for (let n = 0; n < 64; ++n) show(view, strip(n % 8, Math.floor(n / 8), triangles));
      if (triangles >= 21) made.add(meshesOf(view)[0]!.geometry);
    }
    expect(drawn(view)).toHaveLength(59 * 64);
    expect(made.size).toBeLessThan(8);
  });

  it('copies what is displayed, which stays', () => {
    const view = new TileView(new THREE.MeshBasicMaterial());
    show(view, at(0, 0, -1));
    const [copy] = view.copies();
    show(view, at(0, 0, -5));
    const heights = (mesh: THREE.Mesh): number => mesh.geometry.getAttribute('position').getZ(0);
    expect(heights(copy!)).toBeCloseTo(-1, 3);
    expect(heights(meshesOf(view)[0]!)).toBeCloseTo(-5, 3);
  });

  it('displays all tiles that one node stands for, and replaces one of them', () => {
    const view = new TileView(new THREE.MeshBasicMaterial());
    const tile = parsed({ ...triangle(1, 2, 1), repeat: [2, 3] });
    expect([tile.columns, tile.rows]).toEqual([2, 3]);
    show(view, tile);
    const all = ['8 0', '8 8', '8 16', '16 0', '16 8', '16 16'].sort();
    expect(places(view)).toEqual(all);
    show(view, parsed(gone(2, 3)));
    expect(places(view)).toEqual(all.filter((place) => place !== '16 8'));
  });
});
