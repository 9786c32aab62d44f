// SPDX-License-Identifier: Apache-2.0
// Lists the files that kerf.html keeps for use without a network (src/local/offline.ts).

import { createHash } from 'node:crypto';
import { readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import type { Plugin } from 'vite';

/** Fonts of other scripts, the pages of a server and its module are left out. */
const KEPT = [
  /^kerf\.html$/,
  /^kerf_files\.wasm$/,
  /^kerf\.webmanifest$/,
  /^icon.*\.(svg|png)$/,
  /^assets\/.*\.(js|css|wasm)$/,
  /^assets\/inter-latin-.*\.woff2$/,
];

/** Writes `offline.json`: the files, and a version that differs for other contents. */
export function offlineList(): Plugin {
  let folder = '';
  return {
    name: 'offline-list',
    apply: 'build',
    configResolved: ({ root, build }) => {
      folder = join(root, build.outDir);
    },
    closeBundle: () => {
      const files = readdirSync(folder, { recursive: true, encoding: 'utf8' })
        .filter((name) => KEPT.some((pattern) => pattern.test(name)))
        .sort();
      const hash = createHash('sha256');
      for (const name of files) hash.update(name).update(readFileSync(join(folder, name)));
      const version = hash.digest('hex').slice(0, 16);
      writeFileSync(join(folder, 'offline.json'), JSON.stringify({ version, files }));
    },
  };
}
