// SPDX-License-Identifier: Apache-2.0
import type { HtmlTagDescriptor, Plugin } from 'vite';
import { defineConfig } from 'vitest/config';
import { compress } from './bundle/compress';
import { hasModule, willHaveModule } from './bundle/modules';
import { offlineList } from './bundle/offline_list';
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

export default defineConfig({
  base: './',
  define: {
    KERF_HAS_KERNEL: willHaveModule('kerf.wasm'),
    KERF_HAS_FILES: willHaveModule('kerf_files.wasm'),
    KERF_IS_SINGLE: false,
    KERF_HAS_SINGLE: hasModule('kerf_files.wasm'), // which is in it
  },
  json: { namedExports: false },
  plugins: [
    preloadView(),
    manual(),
    offlineList(),
    compress(/\.(js|css|html|svg|wasm|webmanifest)$/),
  ],
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
