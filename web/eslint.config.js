// SPDX-License-Identifier: Apache-2.0
// Lints for correctness, with type information where the file is TypeScript. Layout is prettier's.
// Runs in the repository root (npm run lint), so that it includes tests/e2e.

import js from '@eslint/js';
import { defineConfig } from 'eslint/config';
import globals from 'globals';
import tseslint from 'typescript-eslint';

export default defineConfig(
  { ignores: ['**/dist'] },
  { linterOptions: { reportUnusedDisableDirectives: 'error' } },
  js.configs.recommended,
  {
    files: ['**/*.{ts,tsx,mts}'],
    extends: [tseslint.configs.strictTypeChecked, tseslint.configs.stylisticTypeChecked],
    languageOptions: {
      parserOptions: { projectService: true, tsconfigRootDir: import.meta.dirname },
    },
    rules: {
      // noUncheckedIndexedAccess makes every array access nullable; `!` marks indices in range.
      '@typescript-eslint/no-non-null-assertion': 'off',
      '@typescript-eslint/no-confusing-void-expression': ['error', { ignoreArrowShorthand: true }],
      '@typescript-eslint/no-unused-vars': ['error', { ignoreRestSiblings: true }],
      '@typescript-eslint/restrict-template-expressions': ['error', { allowNumber: true }],
    },
  },
  {
    files: ['**/*.mjs'],
    languageOptions: { globals: globals.node },
    rules: { 'no-use-before-define': ['error', { functions: false }] }, // tsc does it for .ts
  },
  { files: ['web/public/offline.js'], languageOptions: { globals: globals.serviceworker } },
  // Functions given to page.evaluate() run in the browser.
  {
    files: [
      'tests/e2e/*_live.mjs',
      'tests/e2e/page_bench.mjs',
      'tests/e2e/picture_bench.mjs',
      'tests/e2e/support/axe.mjs',
      'tests/e2e/support/block.mjs',
      'tests/e2e/support/browser.mjs',
      'tests/e2e/support/drop.mjs',
      'tests/e2e/support/firefox.mjs',
      'tests/e2e/support/headset.mjs',
      'tests/e2e/support/layout.mjs',
      'tests/e2e/support/likeness.mjs',
      'tests/e2e/support/kept.mjs',
      'tests/e2e/support/meter.mjs',
      'tests/e2e/support/pictures.mjs',
      'tests/e2e/support/texts.mjs',
    ],
    languageOptions: { globals: { ...globals.node, ...globals.browser } },
  },
);
