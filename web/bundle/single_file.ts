// SPDX-License-Identifier: Apache-2.0
// Makes kerf.html one file, which a browser opens from a folder: there, no page may fetch another
// file, nor load a module or a worker from one.

import { readFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';
import type { Plugin, Rollup } from 'vite';
import { modulePath } from './modules';

/** How the page starts its workers. */
const WORKER = /new Worker\(new URL\('([^']+)', import\.meta\.url\), \{ type: 'module' \}\)/g;

/** Has Vite put the code of each worker into the page, as a blob. */
export function inlineWorkers(): Plugin {
  return {
    name: 'inline-workers',
    enforce: 'pre',
    transform: (code) => {
      const imports: string[] = [];
      const inlined = code.replace(WORKER, (_, path: string) => {
        const name = `InlineWorker${imports.length}`;
        imports.push(`import ${name} from '${path}?worker&inline';`);
        return `new ${name}()`;
      });
      return imports.length === 0 ? null : { code: imports.join('\n') + inlined, map: null };
    },
  };
}

function textOf(bundle: Rollup.OutputBundle, ending: string): string {
  const found = Object.values(bundle).filter(({ fileName }) => fileName.endsWith(ending));
  return found.map((file) => (file.type === 'chunk' ? file.code : String(file.source))).join('\n');
}

/** A WebAssembly module as an element, from which kernel/module.ts reads it. */
function moduleElement(name: string): string {
  const packed = gzipSync(readFileSync(modulePath(name)), { level: 9 }).toString('base64');
  return `<script type="application/gzip" id="${name}">${packed}</script>`;
}

/**
 * Writes the one file `name` in place of `html` and of all that it loads. A `</script` or `<!--` in
 * the code is in a string, where `\u003c` is the same.
 */
export function singleFile(html: string, name: string, modules: readonly string[]): Plugin {
  return {
    name: 'single-file',
    apply: 'build',
    enforce: 'post',
    generateBundle: {
      order: 'post',
      handler(_, bundle) {
        const code = textOf(bundle, '.js').replace(/<(?=\/script|!--)/gi, '\\u003c');
        const icon = readFileSync(modulePath('icon.svg')).toString('base64');
        const page = textOf(bundle, html)
          .replace(/^\s*<script type="module".*<\/script>$/m, '')
          .replace(/^\s*<link rel="(stylesheet|modulepreload|manifest|apple-touch-icon)".*>$/gm, '')
          .replace('</head>', () => `<style>${textOf(bundle, '.css')}</style>\n</head>`)
          .replace('</body>', () => {
            const elements = [
              ...modules.map(moduleElement),
              `<script type="module">${code}</script>`,
            ];
            return `${elements.join('\n')}\n</body>`;
          });
        for (const file of Object.keys(bundle)) Reflect.deleteProperty(bundle, file);
        const source = page.replaceAll('./icon.svg', `data:image/svg+xml;base64,${icon}`);
        this.emitFile({ type: 'asset', fileName: name, source });
      },
    },
  };
}
