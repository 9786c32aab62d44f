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

/** The drawn corners: those of all triangles that have an area, by the meshes of the scene, mm. */
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

/** A slab between the heights `low` and `high`. */
const slab = (low: number, high: number): ParsedTile => {
  const square = [0, 0, 8, 0, 8, 8, 0, 8];
  const face = (z: number): number[] =>
    [0, 2, 4, 6].flatMap((n) => [square[n]!, square[n + 1]!, z]);
  return parsed({
    ...triangle(0, 0, 1, [...face(high), ...face(low)]),
    normals: [1, -1].flatMap((up) => [0, 1, 2, 3].flatMap(() => [0, 0, up])),
    indices: [0, 1, 2, 0, 2, 3, 4, 6, 5, 4, 7, 6],
  });
};

/** The edges of triangles that no other has in the opposite direction, each with its number. */
function openEdges(triangles: string[]): string[] {
  const open = new Map<string, number>();
  for (const triangle of triangles) {
    const corners = triangle.split(', ');
    corners.forEach((from, n) => {
      const to = corners[(n + 1) % 3]!;
      const [edge, step] = from < to ? [`${from}, ${to}`, 1] : [`${to}, ${from}`, -1];
      open.set(edge, (open.get(edge) ?? 0) + step);
    });
  }
  return [...open]
    .filter(([, count]) => count !== 0)
    .map(([edge, count]) => `${edge}: ${count}`)
    .sort();
}

/** Twice the area of triangles, of those that face upward and of the others, seen from above. */
function areas(triangles: string[]): [up: number, down: number] {
  const sum: [number, number] = [0, 0];
  for (const triangle of triangles) {
    const [a, b, c] = triangle.split(', ').map((corner) => corner.split(' ').map(Number));
    const twice = (b![0]! - a![0]!) * (c![1]! - a![1]!) - (c![0]! - a![0]!) * (b![1]! - a![1]!);
    sum[twice > 0 ? 0 : 1] += twice;
  }
  return sum;
}

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

  it('draws an untouched square with a triangle for each edge of its rim', () => {
    const view = new TileView(new THREE.MeshBasicMaterial());
    for (let n = 0; n < 256; ++n) view.set(slab(-20, 0), n % 16, Math.floor(n / 16), 8);
    view.mergeSlabs();
    expect(drawn(view)).toHaveLength(2 * 4 * 16);
    expect(openEdges(drawn(view))).toEqual(openEdges(displayed(view)));
    expect(areas(drawn(view))).toEqual(areas(displayed(view)));
  });

  it('draws rectangles of slabs that fit their surroundings after any change', () => {
    const view = new TileView(new THREE.MeshBasicMaterial());
    const shapes = [slab(-20, 0), slab(-20, -5), parsed(waves(0, 0, 2)), slab(-20, 0)];
    const side = 24; // two squares in each direction, the second of which is not full
    const order = shuffled(side * side);
    for (const n of order) view.set(shapes[0]!, n % side, Math.floor(n / side), 8);
    let most = 0;
    for (const [step, n] of order.slice(0, 96).entries()) {
      const [x, y] = [n % side, Math.floor(n / side)];
      const shape = [0, 1, 1, 2, 0, 3][step % 6]!;
      if (step % 11 === 0) view.remove(tileKey(x, y));
      else view.set(shapes[shape]!, x, y, 8);
      if (step % 8 !== 0) continue;
      view.mergeSlabs();
      most = Math.max(most, displayed(view).length - drawn(view).length);
      expect(openEdges(drawn(view))).toEqual(openEdges(displayed(view)));
      expect(areas(drawn(view))).toEqual(areas(displayed(view)));
      if (step % 16 !== 0) continue;
      // A slab that changes before the next picture leaves no hole meanwhile.
      view.set(shapes[2]!, x, y, 8);
      expect(openEdges(drawn(view))).toEqual(openEdges(displayed(view)));
    }
    expect(most).toBeGreaterThan(1000);
  });

  it('does not merge slabs of which some are cut', () => {
    const view = new TileView(new THREE.MeshBasicMaterial());
    const cut = slab(-20, 0);
    const original = cut.geometry!.getAttribute(ORIGINAL_ATTRIBUTE);
    const other = slab(-20, 0);
    const changed = other.geometry!.getAttribute(ORIGINAL_ATTRIBUTE);
    for (let n = 0; n < 4; ++n) changed.setX(n, 1 - original.getX(n));
    for (let n = 0; n < 32; ++n) view.set(n % 8 < 4 ? cut : other, n % 8, Math.floor(n / 8), 8);
    view.mergeSlabs();
    expect(openEdges(drawn(view))).toEqual(openEdges(displayed(view)));
    expect(drawn(view)).toHaveLength(2 * 2 * 16);
    for (const triangle of drawn(view)) {
      const xs = triangle.split(', ').map((corner) => Number(corner.split(' ')[0]));
      expect(Math.min(...xs) < 32 && Math.max(...xs) > 32).toBe(false);
    }
  });

  it('draws a large block in few calls', () => {
    const view = new TileView(new THREE.MeshBasicMaterial());
    for (let n = 0; n < 63 * 63; ++n) show(view, at(n % 63, Math.floor(n / 63), -(n % 9)));
    expect(view.group.children).toHaveLength(16);
  });

  it('gives the GPU the replaced part, not the whole square', () => {
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

  it('keeps normals and the flags of the original surface', () => {
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

  it('copies the displayed tiles, which stay', () => {
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
