// SPDX-License-Identifier: Apache-2.0
import { gzipSync } from 'node:zlib';
import { afterEach, describe, expect, it, vi } from 'vitest';

import { moduleBeside } from '../../src/kernel/module';

const EMPTY = new Uint8Array([0, 0x61, 0x73, 0x6d, 1, 0, 0, 0]); // a module without anything

function serve(status: number, type: string): void {
  vi.stubGlobal('document', {
    baseURI: 'http://kerf.example/page/',
    getElementById: () => null,
  });
  vi.stubGlobal('fetch', (url: URL) => {
    expect(url.href).toBe('http://kerf.example/page/kerf.wasm');
    return Promise.resolve(new Response(EMPTY, { status, headers: { 'content-type': type } }));
  });
}

describe("a module in the page's folder", () => {
  afterEach(() => vi.unstubAllGlobals());

  it('is compiled, whatever type the host gives it', async () => {
    for (const type of ['application/wasm', 'application/octet-stream']) {
      serve(200, type);
      expect(await moduleBeside('kerf.wasm')).toBeInstanceOf(WebAssembly.Module);
    }
  });

  it('is read from the page that has it packed in an element', async () => {
    const textContent = gzipSync(EMPTY).toString('base64');
    const getElementById = (id: string) => (id === 'kerf.wasm' ? { textContent } : null);
    vi.stubGlobal('document', { baseURI: 'file:///kerf.html', getElementById });
    expect(await moduleBeside('kerf.wasm')).toBeInstanceOf(WebAssembly.Module);
  });

  it('is none while run.sh still builds it', async () => {
    serve(404, 'application/json');
    expect(await moduleBeside('kerf.wasm')).toBeNull();
  });
});
