// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { keepBuild } from '../../src/local/offline';

/** The files of each cache; a file that the host lacks rejects all of them, as in browsers. */
class FakeCaches {
  readonly files = new Map<string, string[]>();
  lacks = '';
  keys = (): Promise<string[]> => Promise.resolve([...this.files.keys()]);
  has = (name: string): Promise<boolean> => Promise.resolve(this.files.has(name));
  delete = (name: string): Promise<boolean> => Promise.resolve(this.files.delete(name));
  open = (name: string) => {
    this.files.set(name, []);
    return Promise.resolve({
      addAll: (requests: Request[]): Promise<void> => {
        const paths = requests.map(({ url }) => new URL(url).pathname);
        if (paths.includes(this.lacks)) return Promise.reject(new Error('404'));
        this.files.set(name, paths);
        return Promise.resolve();
      },
    });
  };
}

describe('the files for use without a network', () => {
  let kept: FakeCaches;
  const asked: RequestCache[] = [];

  beforeEach(() => {
    kept = new FakeCaches();
    asked.length = 0;
    vi.stubGlobal('caches', kept);
    vi.stubGlobal(
      'Request',
      class {
        readonly url;
        constructor(
          path: string,
          readonly init: RequestInit,
        ) {
          this.url = new URL(path, 'http://host/').href;
          asked.push(init.cache!);
        }
      },
    );
  });
  afterEach(() => vi.unstubAllGlobals());

  const build = (version: string, files: string[]): void =>
    void vi.stubGlobal('fetch', () => Promise.resolve(Response.json({ version, files })));

  it('are those of the build, asked of the host', async () => {
    build('1', ['kerf.html', 'assets/a.js']);
    await keepBuild();
    expect([...kept.files]).toEqual([['kerf-1', ['/kerf.html', '/assets/a.js']]]);
    expect(new Set(asked)).toEqual(new Set(['no-cache']));
  });

  it('take the place of those of an earlier build, and of nothing else', async () => {
    kept.files.set('other', ['/x']);
    build('1', ['kerf.html']);
    await keepBuild();
    build('2', ['kerf.html']);
    await keepBuild();
    expect([...kept.files.keys()]).toEqual(['other', 'kerf-2']);
  });

  it('stay those of the earlier build where one of the newer is missing', async () => {
    build('1', ['kerf.html']);
    await keepBuild();
    kept.lacks = '/kerf_files.wasm';
    build('2', ['kerf.html', 'kerf_files.wasm']);
    await expect(keepBuild()).rejects.toThrow('404');
    expect([...kept.files.keys()]).toEqual(['kerf-1']);
  });
});
