// SPDX-License-Identifier: Apache-2.0
// Checks the imports of web/src, type-only ones included: each folder imports only the folders that
// layers.json permits, and no file imports itself through other files.
import { readdirSync, readFileSync } from 'node:fs';
import { posix } from 'node:path';
import ts from 'typescript';
import { describe, expect, it } from 'vitest';

import layers from '../layers.json';

const ROOT = new URL('../src/', import.meta.url);

const files: readonly string[] = readdirSync(ROOT, { recursive: true, encoding: 'utf8' })
  .map((path) => path.replaceAll('\\', '/'))
  .filter((path) => /\.(ts|tsx|css|json)$/.test(path));

/** Returns the file that `specifier` names in a file of `folder`; undefined if it is a package. */
function resolve(folder: string, specifier: string): string | undefined {
  if (!specifier.startsWith('.')) return undefined;
  const path = posix.join(folder, specifier.split('?')[0]!);
  const found = ['', '.ts', '.tsx', '/index.ts'].find((end) => files.includes(path + end));
  if (found === undefined) throw new Error(`${folder}: no file for ${specifier}`);
  return path + found;
}

/** Returns the files that a file imports, in any way, or loads as a worker. */
function importsOf(path: string): string[] {
  if (!/\.tsx?$/.test(path)) return [];
  const text = readFileSync(new URL(path, ROOT), 'utf8');
  const { importedFiles } = ts.preProcessFile(text, true, true);
  const workers = [...text.matchAll(/new URL\('(\.[^']+)', import\.meta\.url\)/g)];
  const specifiers = [
    ...importedFiles.map(({ fileName }) => fileName),
    ...workers.map((m) => m[1]!),
  ];
  const folder = posix.dirname(path);
  return specifiers.flatMap((specifier) => resolve(folder, specifier) ?? []);
}

/** Returns a path through the graph that ends where it begins; empty if there is none. */
function circleIn(graph: ReadonlyMap<string, readonly string[]>): string[] {
  const done = new Set<string>();
  const visit = (node: string, path: readonly string[]): string[] => {
    if (path.includes(node)) return [...path.slice(path.indexOf(node)), node];
    if (done.has(node)) return [];
    for (const next of graph.get(node) ?? []) {
      const circle = visit(next, [...path, node]);
      if (circle.length > 0) return circle;
    }
    done.add(node);
    return [];
  };
  for (const node of graph.keys()) {
    const circle = visit(node, []);
    if (circle.length > 0) return circle;
  }
  return [];
}

const graph = new Map(files.map((path) => [path, importsOf(path)]));
const permitted = new Map<string, readonly string[]>(Object.entries(layers));

/** Returns the folder imports of web/src as `from -> to`, each with one import as its example. */
function folderImports(): Map<string, string> {
  const found = new Map<string, string>();
  for (const [path, targets] of graph) {
    for (const target of targets) {
      const [from, to] = [posix.dirname(path), posix.dirname(target)];
      if (from !== to) found.set(`${from} -> ${to}`, `${path} imports ${target}`);
    }
  }
  return found;
}

describe('the imports of web/src', () => {
  it('form no circle of files', () => {
    expect(circleIn(graph)).toEqual([]);
  });

  it('stay within the table of folders', () => {
    const violations = [...folderImports()]
      .filter(([edge]) => {
        const [from, to] = edge.split(' -> ') as [string, string];
        return !permitted.get(from)?.includes(to);
      })
      .map(([, example]) => example);
    expect(violations).toEqual([]);
  });

  it('use each permission of the table', () => {
    const used = folderImports();
    const unused = [...permitted]
      .flatMap(([from, targets]) => targets.map((to) => `${from} -> ${to}`))
      .filter((edge) => !used.has(edge));
    expect(unused).toEqual([]);
  });
});

describe('the table of folders', () => {
  it('names each folder of web/src', () => {
    const folders = new Set(files.map((path) => posix.dirname(path)));
    expect([...permitted.keys()].sort()).toEqual([...folders].sort());
  });

  it('permits a folder only the folders above it, so that no circle is possible', () => {
    const order = [...permitted.keys()];
    const upward = order.flatMap((from, n) =>
      permitted
        .get(from)!
        .filter((to) => !order.slice(0, n).includes(to))
        .map((to) => `${from} -> ${to}`),
    );
    expect(upward).toEqual([]);
  });
});

describe('the search for circles', () => {
  it('returns the circle, from where it is entered', () => {
    const files = new Map([
      ['a', ['b']],
      ['b', ['c']],
      ['c', ['d', 'b']],
      ['d', []],
    ]);
    expect(circleIn(files)).toEqual(['b', 'c', 'b']);
  });

  it('accepts two paths to one file', () => {
    const files = new Map([
      ['a', ['b', 'c']],
      ['b', ['d']],
      ['c', ['d']],
      ['d', []],
    ]);
    expect(circleIn(files)).toEqual([]);
  });
});
