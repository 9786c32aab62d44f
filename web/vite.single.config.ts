// SPDX-License-Identifier: Apache-2.0
// Builds dist/kerf-single.html, kerf.html as one file that a browser opens from a folder.

import { defineConfig } from 'vite';
import { compress } from './bundle/compress';
import { hasModule } from './bundle/modules';
import { inlineWorkers, singleFile } from './bundle/single_file';

const NAME = 'kerf-single.html';
const MODULE = 'kerf_files.wasm';
const EVERYTHING = Number.MAX_SAFE_INTEGER;

export default defineConfig({
  base: './',
  define: {
    // Only the page of a server uses the copy of its block.
    KERF_HAS_KERNEL: false,
    KERF_HAS_FILES: hasModule(MODULE),
    KERF_IS_SINGLE: true,
    KERF_HAS_SINGLE: false,
  },
  json: { namedExports: false },
  publicDir: false,
  plugins: [
    inlineWorkers(),
    singleFile('kerf.html', NAME, hasModule(MODULE) ? [MODULE] : []),
    compress(/^kerf-single\.html$/),
  ],
  worker: { format: 'iife' },
  build: {
    target: 'es2022',
    emptyOutDir: false,
    assetsInlineLimit: EVERYTHING,
    cssCodeSplit: false,
    chunkSizeWarningLimit: 5000,
    modulePreload: false,
    rollupOptions: { input: 'kerf.html', output: { inlineDynamicImports: true } },
  },
});
