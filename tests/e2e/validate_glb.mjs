// SPDX-License-Identifier: Apache-2.0
// Validates GLB files with Khronos's gltf-validator. Usage: node validate_glb.mjs FILE.glb...
// Prints one line per file and every message except hints. Exit code 1 if any file has an error or
// a warning.
import { readFile } from 'node:fs/promises';
import { basename } from 'node:path';
import validator from 'gltf-validator';

const SEVERITIES = ['error', 'warning', 'info', 'hint'];
const files = process.argv.slice(2);
if (files.length === 0) {
  console.error('usage: node validate_glb.mjs FILE.glb...');
  process.exit(2);
}
let failed = 0;
for (const file of files) {
  const report = await validator.validateBytes(new Uint8Array(await readFile(file)), {
    uri: basename(file),
    format: 'glb',
    maxIssues: 100,
  });
  const { numErrors, numWarnings, numInfos, messages } = report.issues;
  console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos`);
  for (const message of messages) {
    if (message.severity < 3) {
      console.log(
        `  ${SEVERITIES[message.severity]} ${message.code} ${message.pointer}: ${message.message}`,
      );
    }
  }
  if (numErrors + numWarnings > 0) failed += 1;
}
process.exit(failed > 0 ? 1 : 0);
