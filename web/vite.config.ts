// SPDX-License-Identifier: Apache-2.0
import { brotliCompressSync, constants, gzipSync } from 'node:zlib';
import { existsSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import type { HtmlTagDescriptor, Plugin } from 'vite';
import { defineConfig } from 'vitest/config';
import { manual } from './manual/render';

// In development Vite serves the page and forwards /v1 to a running kerf-server (or to `npm run
// fake`). In production the server itself serves dist/.
const server = process.env['KERF_SERVER'] ?? 'http://127.0.0.1:8080';

const CHUNKS = /^assets\/(page|viewer|three)-.*\.js$/;
const LOCAL_CHUNKS = /^assets\/(local_page|viewer|three)-.*\.js$/;

/** Fetches the code of page and picture at once; it runs when texts and connection are there. */
function preloadView(): Plugin {
  return {
    name: 'preload-view',
    transformIndexHtml: {
      order: 'post',
      handler: (_html, { bundle, path }) =>
        Object.keys(bundle ?? {})
          .filter((file) => (path === '/kerf.html' ? LOCAL_CHUNKS : CHUNKS).test(file))
          .map((file): HtmlTagDescriptor => ({
            tag: 'link',
            attrs: { rel: 'modulepreload', crossorigin: true, href: `./${file}` },
            injectTo: 'head',
          })),
    },
  };
}

/** Puts FILE.gz and FILE.br beside each file that shrinks, which the server sends to those who ask. */
function compress(): Plugin {
  let folder = '';
  return {
    name: 'compress',
    apply: 'build',
    configResolved: ({ root, build }) => {
      folder = join(root, build.outDir);
    },
    closeBundle: () => {
      for (const name of readdirSync(folder, { recursive: true, encoding: 'utf8' })) {
        if (!/\.(js|css|html|svg|wasm)$/.test(name)) continue;
        const file = join(folder, name);
        const bytes = readFileSync(file);
        writeFileSync(`${file}.gz`, gzipSync(bytes, { level: 9 }));
        const params = {
          [constants.BROTLI_PARAM_QUALITY]: 11,
          [constants.BROTLI_PARAM_SIZE_HINT]: bytes.length,
        };
        writeFileSync(`${file}.br`, brotliCompressSync(bytes, { params }));
      }
    },
  };
}

/** Whether a module of web/wasm is there, or run.sh builds it while the page is already served. */
function hasModule(name: string): string {
  const isThere = existsSync(join(import.meta.dirname, 'public', name));
  return JSON.stringify(isThere || process.env['KERF_WASM'] === 'later');
}

export default defineConfig({
  base: './',
  define: {
    KERF_HAS_KERNEL: hasModule('kerf.wasm'),
    KERF_HAS_FILES: hasModule('kerf_files.wasm'),
  },
  json: { namedExports: false },
  plugins: [preloadView(), manual(), compress()],
  build: {
    target: 'es2022',
    chunkSizeWarningLimit: 900,
    rollupOptions: {
      input: ['index.html', 'kerf.html'],
      output: {
        manualChunks: { three: ['three'] },
        // The first load contains the names of all chunks, whose hashes do not compress.
        entryFileNames: 'assets/[name]-[hash:6].js',
        chunkFileNames: 'assets/[name]-[hash:6].js',
        assetFileNames: 'assets/[name]-[hash:6][extname]',
      },
    },
  },
  server: { proxy: { '/v1': { target: server, ws: true, changeOrigin: false } } },
  test: { environment: 'node', include: ['test/**/*.test.ts'], testTimeout: 20_000 },
});
