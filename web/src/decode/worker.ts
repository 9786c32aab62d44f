// SPDX-License-Identifier: Apache-2.0
// The worker that decodes mesh frames, so that a large one does not stop the page.

import { MeshoptDecoder } from 'three/examples/jsm/libs/meshopt_decoder.module.js';
import type { Decoded } from './decoded';
import { readMeshGlb } from './mesh_glb';
import type { MeshFrame } from './mesh_glb';

function decoded(glb: Uint8Array): Decoded {
  try {
    return { frame: readMeshGlb(glb, MeshoptDecoder) };
  } catch (problem) {
    return { reason: (problem as Error).message };
  }
}

function buffersOf({ shapes }: MeshFrame): ArrayBuffer[] {
  return shapes.flatMap(({ positions, normals, index }) => [
    positions.array.buffer,
    normals.array.buffer,
    index.buffer,
  ]);
}

onmessage = async ({ data }: MessageEvent<Uint8Array>) => {
  await MeshoptDecoder.ready;
  const answer = decoded(data);
  const transfer = 'frame' in answer ? buffersOf(answer.frame) : [];
  postMessage(answer, { transfer });
};
