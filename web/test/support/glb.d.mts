export interface TestTile {
  x: number;
  y: number;
  version: number;
  positions: number[];
  normals: number[];
  indices: number[];
  original?: number[];
  repeat?: [columns: number, rows: number];
}
export function writeMeshGlb(
  tiles: TestTile[],
  stepMm: number,
  from: number,
  to: number,
): Uint8Array;
