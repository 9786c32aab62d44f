// SPDX-License-Identifier: Apache-2.0
// Compares surfaces, given as the corners of their triangles, nine numbers each.

import assert from 'node:assert/strict';

const STL_HEAD = 84;
const STL_TRIANGLE = 50;

/** The corners of a binary STL. */
export function stlCorners(bytes) {
  const corners = [];
  for (let at = STL_HEAD; at < bytes.length; at += STL_TRIANGLE)
    for (let n = 0; n < 9; n += 1) corners.push(bytes.readFloatLE(at + 12 + 4 * n));
  return corners;
}

/** Volume inside of a closed surface. */
export function volumeOf(corners) {
  let sum = 0;
  for (let t = 0; t < corners.length; t += 9) {
    const [ax, ay, az, bx, by, bz, cx, cy, cz] = corners.slice(t, t + 9);
    sum += ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx);
  }
  return sum / 6;
}

/** Numbers of the vertices of the corners: those within `tolerance` of another are one. */
class Welder {
  constructor(tolerance) {
    this.cells = new Map();
    this.tolerance = tolerance;
    this.count = 0;
  }

  key(x, y, z) {
    return `${x},${y},${z}`;
  }

  find([x, y, z]) {
    const side = 4 * this.tolerance;
    const [i, j, k] = [x, y, z].map((value) => Math.floor(value / side));
    for (let n = 0; n < 27; n += 1) {
      const near = this.key(
        i + (n % 3) - 1,
        j + (Math.floor(n / 3) % 3) - 1,
        k + Math.floor(n / 9) - 1,
      );
      for (const vertex of this.cells.get(near) ?? [])
        if (Math.hypot(vertex.x - x, vertex.y - y, vertex.z - z) <= this.tolerance) return vertex;
    }
    return null;
  }

  add(point) {
    const found = this.find(point);
    if (found) return found.number;
    const [x, y, z] = point;
    const side = 4 * this.tolerance;
    const key = this.key(...point.map((value) => Math.floor(value / side)));
    const vertex = { x, y, z, number: this.count++ };
    this.cells.set(key, [...(this.cells.get(key) ?? []), vertex]);
    return vertex.number;
  }
}

/** Triangles as sorted numbers of their welded vertices, without those of no area. */
function weld(corners, welder) {
  const triangles = [];
  for (let t = 0; t < corners.length; t += 9) {
    const [a, b, c] = [0, 3, 6].map((n) => welder.add(corners.slice(t + n, t + n + 3)));
    if (a !== b && b !== c && c !== a) triangles.push([a, b, c]);
  }
  return triangles;
}

/** Edges that are not shared by as many triangles in one direction as in the other. */
function openEdges(triangles) {
  const edges = new Map();
  for (const [a, b, c] of triangles)
    for (const [from, to] of [
      [a, b],
      [b, c],
      [c, a],
    ]) {
      const key = from < to ? `${from},${to}` : `${to},${from}`;
      edges.set(key, (edges.get(key) ?? 0) + (from < to ? 1 : -1));
    }
  return [...edges.values()].filter((sum) => sum !== 0).length;
}

function isOnBox(point, { min_mm: min, max_mm: max }, tolerance) {
  return point.some(
    (value, n) => Math.abs(value - min[n]) <= tolerance || Math.abs(value - max[n]) <= tolerance,
  );
}

/** Numbers of the vertices that a cut has made: those that are not on the sides of the stock. */
function cutVertices(corners, box, welder) {
  const numbers = new Set();
  for (let n = 0; n < corners.length; n += 3) {
    const point = corners.slice(n, n + 3);
    if (!isOnBox(point, box, welder.tolerance)) numbers.add(welder.add(point));
  }
  return [...numbers].sort((a, b) => a - b);
}

/**
 * Asserts that the page displays the surface of an STL: closed, with its volume, and with the same
 * vertices. Only on the sides of the box that is the stock are there others, because the triangles of
 * an STL are larger where nothing was cut.
 */
export function assertSameSurface(shown, stl, box, tolerance) {
  const expected = stlCorners(stl);
  const welder = new Welder(tolerance);
  const cut = cutVertices(expected, box, welder);
  assert.deepEqual(cutVertices(shown, box, welder), cut, 'other vertices');
  const triangles = weld(shown, welder);
  assert.equal(openEdges(triangles), 0);
  const volumes = [volumeOf(shown), volumeOf(expected)];
  assert(Math.abs(volumes[0] / volumes[1] - 1) < 1e-4, `volumes ${volumes}`);
  return { triangles: triangles.length, cut: cut.length, volume: volumes[0] };
}

/**
 * The area of a closed surface in a plane across the unit vector `normal` at `offset`: the sum over the
 * cut triangles of the signed areas between a point and the line of the cut.
 */
export function sectionArea(corners, normal, offset) {
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const foot = normal.map((value) => value * offset);
  let area = 0;
  for (let t = 0; t < corners.length; t += 9) {
    const points = [0, 3, 6].map((n) => corners.slice(t + n, t + n + 3));
    const ends = [];
    points.forEach((a, n) => {
      const b = points[(n + 1) % 3];
      const [da, db] = [dot(a, normal) - offset, dot(b, normal) - offset];
      if (da >= 0 === db >= 0) return;
      const point = a.map((value, k) => value + (da / (da - db)) * (b[k] - value) - foot[k]);
      ends.push({ point, rises: db >= 0 });
    });
    if (ends.length < 2) continue;
    ends.sort((a, b) => a.rises - b.rises);
    const [[ax, ay, az], [bx, by, bz]] = ends.map(({ point }) => point);
    area += dot([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], normal) / 2;
  }
  return area;
}
