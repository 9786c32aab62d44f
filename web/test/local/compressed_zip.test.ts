// SPDX-License-Identifier: Apache-2.0
import { spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { compressedZip } from '../../src/local/compressed_zip';

/** Python writes and reads the archives. */
function python(script: string, ...words: string[]): string {
  const { status, stdout, stderr } = spawnSync('python3', ['-c', script, ...words], {
    encoding: 'utf8',
    maxBuffer: 1e8,
  });
  expect(stderr).toBe('');
  expect(status).toBe(0);
  return stdout;
}

const WRITE = `
import base64, io, sys, zipfile
bytes = io.BytesIO()
with zipfile.ZipFile(bytes, "w", int(sys.argv[1])) as zip:
    zip.writestr("[Content_Types].xml", "<Types/>")
    zip.writestr("3D/3dmodel.model", "<vertex x='1' y='2' z='3'/>" * 5000)
    zip.writestr("empty", "")
print(base64.b64encode(bytes.getvalue()).decode())
`;

const READ = `
import json, sys, zipfile
with zipfile.ZipFile(sys.argv[1]) as zip:
    assert zip.testzip() is None
    print(json.dumps([[i.filename, i.file_size, i.compress_type, zip.read(i)[:8].decode()] for i in zip.infolist()]))
`;

describe('an archive of stored parts', () => {
  let folder: string;
  const archive = (method: number): Uint8Array<ArrayBuffer> =>
    new Uint8Array(Buffer.from(python(WRITE, String(method)), 'base64'));

  beforeEach(() => {
    folder = mkdtempSync(join(tmpdir(), 'kerf-test-'));
  });
  afterEach(() => {
    rmSync(folder, { recursive: true });
    vi.unstubAllGlobals();
  });

  it('is compressed, and another program reads the same parts', async () => {
    const stored = archive(0);
    const compressed = new Uint8Array(await (await compressedZip(stored)).arrayBuffer());
    expect(compressed.length).toBeLessThan(stored.length / 50);
    const file = join(folder, 'model.3mf');
    writeFileSync(file, compressed);
    expect(JSON.parse(python(READ, file))).toEqual([
      ['[Content_Types].xml', 8, 8, '<Types/>'],
      ['3D/3dmodel.model', 135000, 8, '<vertex '],
      ['empty', 0, 8, ''],
    ]);
  });

  it('has a header before each part that leads to the next one', async () => {
    const bytes = await (await compressedZip(archive(0))).arrayBuffer();
    const view = new DataView(bytes);
    let [at, parts] = [0, 0];
    for (; view.getUint32(at, true) === 0x04034b50; parts += 1) {
      expect(view.getUint16(at + 8, true)).toBe(8);
      at += 30 + view.getUint16(at + 26, true) + view.getUint32(at + 18, true);
    }
    expect([parts, view.getUint32(at, true)]).toEqual([3, 0x02014b50]);
  });

  it('stays where the browser does not compress', async () => {
    const stored = archive(0);
    vi.stubGlobal('CompressionStream', undefined);
    expect(new Uint8Array(await (await compressedZip(stored)).arrayBuffer())).toEqual(stored);
  });

  it('is no other archive, and no other file', async () => {
    await expect(compressedZip(archive(8))).rejects.toThrow('no part that is stored');
    await expect(compressedZip(new Uint8Array(10))).rejects.toThrow('no end of an archive');
    await expect(compressedZip(new Uint8Array(100))).rejects.toThrow('no end of an archive');
  });
});
