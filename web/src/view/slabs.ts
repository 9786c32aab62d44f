// SPDX-License-Identifier: Apache-2.0
// Finds rectangles of slabs, to draw them with fewer triangles. A slab is a tile with one
// horizontal square above and one below, as of stock that nothing has cut. The rim of a rectangle
// keeps the corners of its tiles, so that it fits its surroundings as exactly as they do.

const VERTICES = 8;
const INDICES = 12;

/** The corners of a face: at the least x and y, then counter-clockwise seen from above. */
type Corners = readonly [number, number, number, number];

export interface Slab {
  /** Equal for slabs that lie in the same planes. */
  planes: string;
  /** Numbers of vertices. */
  top: Corners;
  bottom: Corners;
}

/** Tiles from x, y up, and the triangles that take the place of theirs. */
export interface SlabRectangle {
  x: number;
  y: number;
  columns: number;
  rows: number;
  indices: number[];
}

/** The corners of a face, if these four vertices are the corners of a rectangle; else null. */
function cornersOf(xy: (n: number, axis: 0 | 1) => number, face: number[]): Corners | null {
  const [xs, ys] = ([0, 1] as const).map((axis) => face.map((n) => xy(n, axis)));
  const [left, right] = [Math.min(...xs!), Math.max(...xs!)];
  const [near, far] = [Math.min(...ys!), Math.max(...ys!)];
  const at = (x: number, y: number): number | undefined =>
    face.find((n) => xy(n, 0) === x && xy(n, 1) === y);
  const found = [at(left, near), at(right, near), at(right, far), at(left, far)];
  if (left === right || near === far || found.includes(undefined)) return null;
  return found as unknown as Corners;
}

/**
 * Returns the slab that a tile is; null if it is another shape.
 *
 * @param positions of all vertices, of which those of the tile begin at `first`
 * @param upward the third component of a vertex' normal, and what else its face has in common
 */
export function slabOf(
  positions: ArrayLike<number>,
  [first, vertices, indices]: [first: number, vertices: number, indices: number],
  upward: (vertex: number) => { z: number; original: number },
): Slab | null {
  if (vertices !== VERTICES || indices !== INDICES) return null;
  const all = Array.from({ length: VERTICES }, (_, n) => first + n);
  const heights = [...new Set(all.map((n) => positions[3 * n + 2]!))].sort((a, b) => a - b);
  if (heights.length !== 2) return null;
  const faces = heights.map((z) => all.filter((n) => positions[3 * n + 2] === z));
  if (faces.some((face) => face.length !== 4)) return null;
  const isEven = faces.every((face, k) =>
    face.every((n) => {
      const { z, original } = upward(n);
      return z * (2 * k - 1) > 0 && original === upward(face[0]!).original;
    }),
  );
  const xy = (n: number, axis: 0 | 1): number => positions[3 * n + axis]!;
  const [bottom, top] = faces.map((face) => cornersOf(xy, face));
  if (!isEven || !bottom || !top) return null;
  const originals = faces.map((face) => upward(face[0]!).original);
  return { planes: [...heights, ...originals].join(' '), top, bottom };
}

/** A fan about the middle of a rectangle of faces, with all corners of the tiles at its rim. */
function fanOf(
  { x, y, columns, rows }: Omit<SlabRectangle, 'indices'>,
  cornersAt: (x: number, y: number) => Corners,
): number[] {
  const [right, far] = [x + columns - 1, y + rows - 1];
  const rim: number[] = [];
  for (let n = x; n <= right; n += 1) rim.push(cornersAt(n, y)[0]);
  for (let n = y; n <= far; n += 1) rim.push(cornersAt(right, n)[1]);
  for (let n = right; n >= x; n -= 1) rim.push(cornersAt(n, far)[2]);
  for (let n = far; n >= y; n -= 1) rim.push(cornersAt(x, n)[3]);
  const middle = cornersAt(x + (columns >> 1), y + (rows >> 1))[0];
  return rim.flatMap((corner, n) => [middle, corner, rim[(n + 1) % rim.length]!]);
}

/**
 * Finds rectangles of slabs that are drawn with fewer triangles together. Slabs that are in none are
 * drawn as they are.
 *
 * @param side the tiles are at 0, 0 to side - 1, side - 1
 */
export function slabRectangles(
  side: number,
  slabAt: (x: number, y: number) => Slab | null,
): SlabRectangle[] {
  const taken = new Set<number>();
  const isFree = (x: number, y: number, planes: string): boolean =>
    x < side && y < side && !taken.has(y * side + x) && slabAt(x, y)?.planes === planes;
  const found: SlabRectangle[] = [];
  for (let y = 0; y < side; y += 1)
    for (let x = 0; x < side; x += 1) {
      const planes = slabAt(x, y)?.planes;
      if (planes === undefined || taken.has(y * side + x)) continue;
      const [columns, rows] = largest(x, y, (column, row) => isFree(column, row, planes));
      if (saved(columns, rows) <= 0) continue;
      for (let row = y; row < y + rows; row += 1)
        for (let column = x; column < x + columns; column += 1) taken.add(row * side + column);
      const place = { x, y, columns, rows };
      const top = fanOf(place, (column, row) => slabAt(column, row)!.top);
      const bottom = fanOf(place, (column, row) => slabAt(column, row)!.bottom).reverse();
      found.push({ ...place, indices: [...top, ...bottom] });
    }
  return found;
}

/** How many triangles of each face a rectangle saves, halved; below 0: it takes more. */
const saved = (columns: number, rows: number): number => columns * rows - columns - rows;

/** The rectangle of free tiles from x, y up that saves most: columns and rows. */
function largest(
  x: number,
  y: number,
  isFree: (x: number, y: number) => boolean,
): [columns: number, rows: number] {
  let best: [number, number] = [1, 1];
  let width = Infinity;
  for (let rows = 1; isFree(x, y + rows - 1); rows += 1) {
    let columns = 0;
    while (columns < width && isFree(x + columns, y + rows - 1)) columns += 1;
    width = columns;
    if (saved(width, rows) > saved(...best)) best = [width, rows];
  }
  return best;
}
