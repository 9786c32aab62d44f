// SPDX-License-Identifier: Apache-2.0
// Independent checks of exported files: gltf-validator for GLB, admesh for STL.

import assert from 'node:assert/strict';
import validator from 'gltf-validator';
import { run } from './processes.mjs';

/** Returns the validator's errors about a GLB, one string each. */
export async function gltfErrors(bytes, name) {
  const { issues } = await validator.validateBytes(new Uint8Array(bytes), { uri: name });
  const errors = issues.messages.filter(({ severity }) => severity === 0);
  assert.equal(errors.length, issues.numErrors);
  return errors.map(({ code, message, pointer }) => `${name}: ${code} ${message} at ${pointer}`);
}

/** Returns the tiles of a mesh frame: coordinates, version, level and number of triangles. */
export function tilesOf(glb) {
  const {
    nodes = [],
    meshes,
    accessors,
  } = JSON.parse(glb.subarray(20, 20 + glb.readUInt32LE(12)).toString());
  return nodes.map(({ extras: { tile, version, level = 0 }, mesh }) => ({
    tile: tile.join(),
    version,
    level,
    triangles: mesh === undefined ? 0 : accessors[meshes[mesh].primitives[0].indices].count / 3,
  }));
}

/**
 * Returns counts of `admesh -n`: facets, and facets that are disconnected, backwards or degenerate.
 */
export async function stlFacts(file) {
  const text = await run('admesh', ['-n', file]);
  const number = (label) => {
    const found = new RegExp(`${label}\\s*:\\s*(\\d+)`).exec(text);
    if (!found) throw new Error(`admesh did not print "${label}":\n${text}`);
    return Number(found[1]);
  };
  return {
    facets: number('Number of facets'),
    disconnected: number('Total disconnected facets'),
    backwards: number('Backwards edges'),
    degenerate: number('Degenerate facets'),
  };
}
