// SPDX-License-Identifier: Apache-2.0
// Writes mesh frames as specified in server/wire/README.md: one node per tile, int16 positions on
// one global lattice, int8 normals, KHR_mesh_quantization. Independent of the viewer's code, so
// that the viewer is not tested against itself.

function pad4(bytes, fill) {
  const padded = new Uint8Array(Math.ceil(bytes.length / 4) * 4).fill(fill);
  padded.set(bytes);
  return padded;
}

/**
 * @param tiles [{x, y, version, positions: Float64Array (mm, world), normals: Float64Array,
 * indices: number[], original?: number[], repeat?: [columns, rows]}]; no indices: an empty tile
 */
export function writeMeshGlb(tiles, stepMm, from, to) {
  const parts = [];
  let offset = 0;
  const gltf = {
    asset: { version: '2.0', generator: 'kerf test support' },
    extensionsUsed: ['KHR_mesh_quantization'],
    extensionsRequired: ['KHR_mesh_quantization'],
    scene: 0,
    scenes: [{ nodes: tiles.map((_, i) => i), extras: { from, to } }],
    nodes: [],
    meshes: [],
    accessors: [],
    bufferViews: [],
    buffers: [],
  };
  const view = (bytes, target, byteStride) => {
    gltf.bufferViews.push({
      buffer: 0,
      byteOffset: offset,
      byteLength: bytes.length,
      target,
      ...(byteStride ? { byteStride } : {}),
    });
    parts.push(bytes);
    offset += bytes.length;
    return gltf.bufferViews.length - 1;
  };
  for (const tile of tiles) {
    const node = {
      name: `t_${tile.x}_${tile.y}`,
      extras: {
        tile: [tile.x, tile.y],
        version: tile.version,
        ...(tile.repeat ? { repeat: tile.repeat } : {}),
      },
    };
    gltf.nodes.push(node);
    if (tile.indices.length === 0) continue;
    addTile(gltf, node, tile, stepMm, view);
  }
  if (gltf.meshes.length === 0) {
    for (const empty of ['meshes', 'accessors', 'bufferViews', 'buffers']) delete gltf[empty];
  } else {
    gltf.buffers.push({ byteLength: offset });
  }
  return container(gltf, parts, offset);
}

function addTile(gltf, node, tile, stepMm, view) {
  const count = tile.positions.length / 3;
  const low = [0, 1, 2].map((k) => {
    let least = Infinity;
    for (let i = k; i < tile.positions.length; i += 3) least = Math.min(least, tile.positions[i]);
    return Math.floor(least / stepMm);
  });
  const positions = new DataView(new ArrayBuffer(count * 8));
  const normals = new DataView(new ArrayBuffer(count * 4));
  const min = [Infinity, Infinity, Infinity];
  const max = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < count; ++i) {
    for (let k = 0; k < 3; ++k) {
      const steps = Math.round(tile.positions[3 * i + k] / stepMm) - low[k] - 32768;
      positions.setInt16(8 * i + 2 * k, steps, true);
      min[k] = Math.min(min[k], steps);
      max[k] = Math.max(max[k], steps);
      normals.setInt8(4 * i + k, Math.round(tile.normals[3 * i + k] * 127));
    }
    normals.setInt8(4 * i + 3, tile.original?.[i] ?? 1);
  }
  const wide = count > 65535;
  const indices = wide ? new Uint32Array(tile.indices) : new Uint16Array(tile.indices);
  const positionView = view(new Uint8Array(positions.buffer), 34962, 8);
  const normalView = view(new Uint8Array(normals.buffer), 34962, 4);
  const indexView = view(pad4(new Uint8Array(indices.buffer), 0), 34963);
  const first = gltf.accessors.length;
  gltf.accessors.push(
    { bufferView: positionView, componentType: 5122, count, type: 'VEC3', min, max },
    { bufferView: normalView, componentType: 5120, normalized: true, count, type: 'VEC3' },
    {
      bufferView: indexView,
      componentType: wide ? 5125 : 5123,
      count: indices.length,
      type: 'SCALAR',
    },
  );
  gltf.meshes.push({
    primitives: [{ attributes: { POSITION: first, NORMAL: first + 1 }, indices: first + 2 }],
  });
  node.mesh = gltf.meshes.length - 1;
  node.translation = low.map((steps) => (steps + 32768) * stepMm);
  node.scale = [stepMm, stepMm, stepMm];
}

function container(gltf, parts, binBytes) {
  const json = pad4(new TextEncoder().encode(JSON.stringify(gltf)), 0x20);
  const total = 12 + 8 + json.length + (binBytes > 0 ? 8 + binBytes : 0);
  const glb = new Uint8Array(total);
  const head = new DataView(glb.buffer);
  head.setUint32(0, 0x46546c67, true);
  head.setUint32(4, 2, true);
  head.setUint32(8, total, true);
  head.setUint32(12, json.length, true);
  head.setUint32(16, 0x4e4f534a, true);
  glb.set(json, 20);
  if (binBytes > 0) {
    let at = 20 + json.length;
    head.setUint32(at, binBytes, true);
    head.setUint32(at + 4, 0x004e4942, true);
    at += 8;
    for (const part of parts) {
      glb.set(part, at);
      at += part.length;
    }
  }
  return glb;
}
