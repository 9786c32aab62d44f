// SPDX-License-Identifier: Apache-2.0
// The WebAssembly modules of web/wasm, as the build finds them.

import { existsSync } from 'node:fs';
import { join } from 'node:path';

/** The path of a module, which may not have been built. */
export function modulePath(name: string): string {
  return join(import.meta.dirname, '../public', name);
}

export function hasModule(name: string): boolean {
  return existsSync(modulePath(name));
}

/** Whether a module is there, or run.sh builds it while the page is already served. */
export function willHaveModule(name: string): boolean {
  return hasModule(name) || process.env['KERF_WASM'] === 'later';
}
