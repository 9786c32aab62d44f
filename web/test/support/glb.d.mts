export interface TestTile {
  x: number;
  y: number;
  version: number;
  positions: number[];
  normals: number[];
  indices: number[];
}
export function writeMeshGlb(
  tiles: TestTile[],
  stepMm: number,
  from: number,
  to: number,
): Uint8Array;
