// SPDX-License-Identifier: Apache-2.0
import { defineConfig } from 'vitest/config';

// In development Vite serves the page and forwards /v1 to a running kerf-server (or to `npm run
// fake`). In production the server itself serves dist/.
const server = process.env['KERF_SERVER'] ?? 'http://127.0.0.1:8080';

export default defineConfig({
  base: './',
  build: {
    target: 'es2022',
    chunkSizeWarningLimit: 900,
    rollupOptions: { output: { manualChunks: { three: ['three'] } } },
  },
  server: { proxy: { '/v1': { target: server, ws: true, changeOrigin: false } } },
  test: { environment: 'node', include: ['test/**/*.test.ts'], testTimeout: 20_000 },
});
