// Judges from outside: the glTF validator, and admesh for STL.

import assert from 'node:assert/strict';
import validator from 'gltf-validator';
import { run } from './processes.mjs';

/** The validator's errors about a GLB, as text; empty if it found none. */
export async function gltfComplaints(bytes, name) {
  const { issues } = await validator.validateBytes(new Uint8Array(bytes), { uri: name });
  const errors = issues.messages.filter(({ severity }) => severity === 0);
  assert.equal(errors.length, issues.numErrors);
  return errors.map(({ code, message, pointer }) => `${name}: ${code} ${message} at ${pointer}`);
}

/** What `admesh -n` counts about a file: facets, and facets that are not connected on all sides. */
export async function stlFacts(file) {
  const text = await run('admesh', ['-n', file]);
  const number = (label) => {
    const found = new RegExp(`${label}\\s*:\\s*(\\d+)`).exec(text);
    if (!found) throw new Error(`admesh does not say "${label}":\n${text}`);
    return Number(found[1]);
  };
  return {
    facets: number('Number of facets'),
    disconnected: number('Total disconnected facets'),
    backwards: number('Backwards edges'),
    degenerate: number('Degenerate facets'),
  };
}
