// SPDX-License-Identifier: Apache-2.0
// Compresses the buffer views of a GLB by meshoptimizer (EXT_meshopt_compression), as the server
// does.

import { MeshoptEncoder } from 'meshoptimizer';

interface View {
  byteOffset: number;
  byteLength: number;
  byteStride?: number;
  target: number;
}
interface Accessor {
  bufferView: number;
  componentType: number;
  count: number;
}
interface Json {
  bufferViews: View[];
  accessors: Accessor[];
  buffers: unknown[];
}

const INDEX_BYTES = new Map([
  [5123, 2],
  [5125, 4],
]);

export function compressGlb(glb: Uint8Array): Uint8Array {
  const head = new DataView(glb.buffer, glb.byteOffset);
  const jsonBytes = head.getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(glb.subarray(20, 20 + jsonBytes))) as Json;
  const binary = glb.subarray(28 + jsonBytes);
  const parts: Uint8Array[] = [];
  let at = 0;
  const bufferViews = json.bufferViews.map((view, n) => {
    const { componentType, count } = json.accessors.find(({ bufferView }) => bufferView === n)!;
    const size = view.byteStride ?? INDEX_BYTES.get(componentType)!;
    const mode = view.byteStride === undefined ? 'TRIANGLES' : 'ATTRIBUTES';
    const source = binary.subarray(view.byteOffset, view.byteOffset + count * size);
    const packed = MeshoptEncoder.encodeGltfBuffer(source, count, size, mode);
    const byteLength = packed.length;
    const EXT_meshopt_compression = {
      ...{ buffer: 0, byteOffset: at, byteLength, byteStride: size },
      ...{ count, mode },
    };
    parts.push(packed);
    at += Math.ceil(byteLength / 4) * 4;
    const stride = view.byteStride === undefined ? {} : { byteStride: size };
    const placed = { buffer: 1, byteOffset: 0, byteLength: count * size, target: view.target };
    return { ...placed, ...stride, extensions: { EXT_meshopt_compression } };
  });
  const buffers = [{ byteLength: at }, { byteLength: binary.length }];
  const used = ['EXT_meshopt_compression', 'KHR_mesh_quantization'];
  const text = JSON.stringify({ ...json, bufferViews, buffers, extensionsUsed: used });
  return container(text, parts, at);
}

function container(text: string, parts: readonly Uint8Array[], binaryBytes: number): Uint8Array {
  const json = new TextEncoder().encode(text.padEnd(Math.ceil(text.length / 4) * 4));
  const glb = new Uint8Array(28 + json.length + binaryBytes);
  const head = new DataView(glb.buffer);
  const words = [0x46546c67, 2, glb.length, json.length, 0x4e4f534a];
  words.forEach((word, n) => head.setUint32(4 * n, word, true));
  glb.set(json, 20);
  head.setUint32(20 + json.length, binaryBytes, true);
  head.setUint32(24 + json.length, 0x004e4942, true);
  let at = 28 + json.length;
  for (const part of parts) {
    glb.set(part, at);
    at += Math.ceil(part.length / 4) * 4;
  }
  return glb;
}
