// SPDX-License-Identifier: Apache-2.0
// A host of files, as any: it knows nothing of Kerf.

import { readFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import { extname, join, normalize } from 'node:path';
import { atEnd } from './processes.mjs';

const TYPES = {
  '.html': 'text/html',
  '.js': 'text/javascript',
  '.css': 'text/css',
  '.svg': 'image/svg+xml',
  '.woff2': 'font/woff2',
};

/**
 * Serves a folder on a free port until the test ends. `missing` collects the addresses that it does
 * not have.
 */
export async function serveFiles(folder) {
  const missing = [];
  const server = createServer((request, response) => {
    const path = normalize(new URL(request.url, 'http://host').pathname);
    readFile(join(folder, path)).then(
      (bytes) => {
        response.setHeader('Content-Type', TYPES[extname(path)] ?? 'application/octet-stream');
        response.end(bytes);
      },
      () => {
        missing.push(path);
        response.statusCode = 404;
        response.end();
      },
    );
  });
  await new Promise((resolve) => {
    server.listen(0, '127.0.0.1', resolve);
  });
  atEnd(() => {
    server.closeAllConnections();
    server.close();
  });
  return { base: `http://127.0.0.1:${server.address().port}`, missing };
}
