// SPDX-License-Identifier: Apache-2.0
// Compares the reader of mesh frames with three.js's GLTFLoader.
import { beforeAll, describe, expect, it } from 'vitest';
import { MeshoptEncoder } from 'meshoptimizer';
import * as THREE from 'three';
import { MeshoptDecoder } from 'three/examples/jsm/libs/meshopt_decoder.module.js';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { readMeshGlb } from '../../src/decode/mesh_glb';
import { ORIGINAL_ATTRIBUTE, tilesOf } from '../../src/view/parsed_tiles';
import type { ParsedTile } from '../../src/view/parsed_tiles';
import { compressGlb } from '../support/compress_glb';
import { writeMeshGlb } from '../support/glb.mjs';
import type { TestTile } from '../support/glb.mjs';
import { NO_DECODER, parsedTiles, STEP_MM, triangle, waves } from '../support/mesh_frames';

beforeAll(async () => {
  // GLTFLoader reads this browser global even for files without images.
  Object.assign(globalThis, { self: globalThis });
  await Promise.all([MeshoptDecoder.ready, MeshoptEncoder.ready]);
});

/** The corners of the triangles and their normals in the world, and the original ones. */
function cornersOf(geometry: THREE.BufferGeometry, matrix: THREE.Matrix4): number[] {
  const { position, normal } = geometry.attributes;
  const values: number[] = [];
  const at = new THREE.Vector3();
  for (const vertex of geometry.index!.array) {
    values.push(...at.fromBufferAttribute(position!, vertex).applyMatrix4(matrix).toArray());
    values.push(...at.fromBufferAttribute(normal!, vertex).toArray());
  }
  return values;
}

async function compareWithLoader(glb: Uint8Array): Promise<void> {
  const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
  const { scene } = await loader.parseAsync(glb.slice().buffer, '');
  const read = tilesOf(readMeshGlb(glb, MeshoptDecoder));
  expect(read).toHaveLength(scene.children.length);
  scene.updateMatrixWorld(true);
  for (const [n, child] of scene.children.entries()) {
    const { x, y, version, geometry, matrix } = read[n]!;
    expect(child.userData).toMatchObject({ tile: [x, y], version });
    expect(geometry !== null).toBe(child instanceof THREE.Mesh);
    if (!(child instanceof THREE.Mesh)) continue;
    const expected = cornersOf(child.geometry as THREE.BufferGeometry, child.matrixWorld);
    const corners = cornersOf(geometry!, matrix);
    expect(corners).toHaveLength(expected.length);
    // All of them are not compared by expect(), which would print them.
    expect(corners.findIndex((value, at) => value !== expected[at])).toBe(-1);
    expect(expected.length).toBeGreaterThan(0);
  }
}

const empty: TestTile = { x: 4, y: 4, version: 8, positions: [], normals: [], indices: [] };
const frame = (): Uint8Array =>
  writeMeshGlb([waves(0, 0, 7), waves(1, 0, 20), empty, triangle(2, 1, 4)], STEP_MM, 5, 17);

describe('a mesh frame', () => {
  it('is read as GLTFLoader reads it', () => compareWithLoader(frame()));

  it('is read as GLTFLoader reads it, compressed by meshoptimizer', async () => {
    const compressed = compressGlb(frame());
    expect(compressed.length).toBeLessThan(0.7 * frame().length);
    await compareWithLoader(compressed);
  });

  it('is read as GLTFLoader reads it with indices of 32 bits', () =>
    compareWithLoader(writeMeshGlb([waves(0, 0, 260)], STEP_MM, 0, 1)));

  it('has its tiles with versions, in world coordinates', () => {
    const tiles = parsedTiles([triangle(1, 11, 4), triangle(11, 1, 7)]);
    expect(tiles.map(({ x, y, version, triangles }) => [x, y, version, triangles])).toEqual([
      [1, 11, 4, 1],
      [11, 1, 7, 1],
    ]);
    const { geometry, matrix } = tiles[0]!;
    const position = geometry!.getAttribute('position') as THREE.BufferAttribute;
    const corner = new THREE.Vector3().fromBufferAttribute(position, 2).applyMatrix4(matrix);
    expect(corner.x).toBeCloseTo(8, 3);
    expect(corner.y).toBeCloseTo(8, 3);
    expect(corner.z).toBeCloseTo(-3, 3);
  });

  it('states how many motions are in it', () => {
    expect(readMeshGlb(frame(), NO_DECODER).motions).toBe(17);
  });

  it('states of each vertex whether it is of the original surface', () => {
    const cut = { ...triangle(0, 0, 1), original: [1, 0, 1] };
    const [whole, part] = parsedTiles([triangle(1, 0, 1), cut]);
    const bits = (tile: ParsedTile): number[] => {
      const original = tile.geometry!.getAttribute(ORIGINAL_ATTRIBUTE);
      return [0, 1, 2].map((n) => original.getX(n));
    };
    expect(bits(whole!)).toEqual([1, 1, 1]);
    expect(bits(part!)).toEqual([1, 0, 1]);
  });

  it('may contain an empty tile', () => {
    expect(parsedTiles([empty])).toMatchObject([{ x: 4, y: 4, version: 8, geometry: null }]);
  });
});

describe('a mesh frame is rejected', () => {
  const broken = (change: (json: string) => string): Uint8Array => {
    const glb = frame();
    const bytes = new DataView(glb.buffer).getUint32(12, true);
    const json = new TextDecoder().decode(glb.subarray(20, 20 + bytes));
    const changed = new TextEncoder().encode(change(json).padEnd(bytes));
    expect(changed).toHaveLength(bytes); // bytes behind it keep their offsets
    glb.set(changed, 20);
    return glb;
  };

  it('if it is not a GLB', () => {
    expect(() => readMeshGlb(new Uint8Array([1, 2, 3, 4]), NO_DECODER)).toThrow();
    expect(() => readMeshGlb(new Uint8Array(64), NO_DECODER)).toThrow('it is not a GLB');
  });

  it('if a node is no tile', () => {
    const glb = broken((json) => json.replace('"tile":[0,0]', '"tile":[0.5]'));
    expect(() => readMeshGlb(glb, NO_DECODER)).toThrow('node "t_0_0" has no valid tile');
  });

  it('if vertices end behind their bytes', () => {
    const glb = broken((json) => json.replace('"count":64', '"count":99'));
    expect(() => readMeshGlb(glb, NO_DECODER)).toThrow('ends behind its buffer view');
  });
});
