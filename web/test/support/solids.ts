// SPDX-License-Identifier: Apache-2.0
// Closed surfaces of known size, as pieces.

import type { Piece } from '../../src/model/surface';
import type { Vec3 } from '../../src/wire/types';

function pieceOf(triangles: readonly Vec3[]): Piece {
  const corners = Float64Array.from(triangles.flat());
  const axis = (n: number): number[] => triangles.map((point) => point[n]!);
  const least = [0, 1, 2].map((n) => Math.min(...axis(n))) as Vec3;
  const greatest = [0, 1, 2].map((n) => Math.max(...axis(n))) as Vec3;
  return { min: least, max: greatest, corners: () => corners };
}

/** Two triangles of a quadrilateral, counterclockwise. */
function quad(a: Vec3, b: Vec3, c: Vec3, d: Vec3): Vec3[] {
  return [a, b, c, a, c, d];
}

/** A box without the sides of these names, such as '+x'. */
export function boxPiece(min: Vec3, max: Vec3, without: readonly string[] = []): Piece {
  const at = (bits: number): Vec3 =>
    [0, 1, 2].map((n) => ((bits >> n) & 1 ? max[n]! : min[n]!)) as Vec3;
  const sides: [string, number, number, number, number][] = [
    ['-x', 0, 4, 6, 2],
    ['+x', 1, 3, 7, 5],
    ['-y', 0, 1, 5, 4],
    ['+y', 2, 6, 7, 3],
    ['-z', 0, 2, 3, 1],
    ['+z', 4, 5, 7, 6],
  ];
  return pieceOf(
    sides
      .filter(([name]) => !without.includes(name))
      .flatMap(([, a, b, c, d]) => quad(at(a), at(b), at(c), at(d))),
  );
}

/**
 * A box around the z axis with a hole along it, as a ring of as many pieces as the hole has sides:
 * half its length and width, its height, the hole's radius.
 */
export function drilledBox(
  halfX: number,
  halfY: number,
  height: number,
  radius: number,
  sides: number,
): Piece[] {
  // The angles of the hole's corners and of the box's corners.
  const corner = Math.atan2(halfY, halfX);
  const angles = [
    ...Array.from({ length: sides }, (_, n) => (2 * Math.PI * n) / sides),
    ...[corner, Math.PI - corner, Math.PI + corner, 2 * Math.PI - corner],
  ].sort((a, b) => a - b);
  const inner = (angle: number, z: number): Vec3 => [
    radius * Math.cos(angle),
    radius * Math.sin(angle),
    z,
  ];
  const outer = (angle: number, z: number): Vec3 => {
    const [x, y] = [Math.cos(angle), Math.sin(angle)];
    const far = Math.min(halfX / Math.abs(x), halfY / Math.abs(y));
    return [far * x, far * y, z];
  };
  return angles.map((a, n) => {
    const b = angles[(n + 1) % angles.length]!;
    return pieceOf([
      ...quad(inner(a, height), outer(a, height), outer(b, height), inner(b, height)),
      ...quad(inner(a, 0), inner(b, 0), outer(b, 0), outer(a, 0)),
      ...quad(outer(a, 0), outer(b, 0), outer(b, height), outer(a, height)),
      ...quad(inner(a, 0), inner(a, height), inner(b, height), inner(b, 0)),
    ]);
  });
}
