// SPDX-License-Identifier: Apache-2.0
import { beforeEach, describe, expect, it, vi } from 'vitest';
import { MemoryFolder } from '../../src/local/memory_folder';

type Calls = Record<string, (...values: (number | bigint)[]) => number>;

const OK = 0;
const CREATE = 1;
const NEW = 9; // create and truncate
const TEXT = new TextEncoder();

describe('the folder of a module', () => {
  const memory = new WebAssembly.Memory({ initial: 40 });
  const view = () => new DataView(memory.buffer);
  let folder: MemoryFolder;
  let calls: Calls;

  beforeEach(() => {
    folder = new MemoryFolder();
    folder.memory = memory;
    // (module (import "wasi_snapshot_preview1" NAME (func)) …)
    const names = ['path_open', 'fd_write', 'fd_read', 'fd_pread', 'fd_seek', 'fd_close'].concat(
      'path_filestat_get',
      'path_unlink_file',
      'fd_prestat_get',
      'clock_time_get',
      'sched_yield',
    );
    const text = (value: string): number[] => [value.length, ...TEXT.encode(value)];
    const from = text('wasi_snapshot_preview1');
    const list = names.flatMap((name) => [...from, ...text(name), 0, 0]);
    const size = list.length + 1;
    const leb = size < 128 ? [size] : [(size & 0x7f) | 0x80, size >> 7];
    const bytes = [0, 0x61, 0x73, 0x6d, 1, 0, 0, 0, 1, 4, 1, 0x60, 0, 0];
    bytes.push(2, ...leb, names.length, ...list);
    const module = new WebAssembly.Module(new Uint8Array(bytes));
    calls = folder.imports(module)['wasi_snapshot_preview1'] as unknown as Calls;
  });

  function put(text: string, at = 1024): [at: number, length: number] {
    const bytes = TEXT.encode(text);
    new Uint8Array(memory.buffer, at, bytes.length).set(bytes);
    return [at, bytes.length];
  }

  function open(name: string, how: number): number {
    const status = calls['path_open']!(3, 0, ...put(name), how, 0n, 0n, 0, 8);
    return status === OK ? view().getUint32(8, true) : -status;
  }

  function write(fd: number, text: string): number {
    const [at, length] = put(text, 4096);
    view().setUint32(16, at, true);
    view().setUint32(20, length, true);
    return calls['fd_write']!(fd, 16, 1, 24);
  }

  function read(call: string, fd: number, length: number, ...offset: bigint[]): string {
    view().setUint32(16, 8192, true);
    view().setUint32(20, length, true);
    expect(calls[call]!(fd, 16, 1, ...offset, 24)).toBe(OK);
    const count = view().getUint32(24, true);
    return new TextDecoder().decode(new Uint8Array(memory.buffer, 8192, count));
  }

  it('returns the files that were put into it', () => {
    folder.put('part.ngc', TEXT.encode('G1 X5'));
    const fd = open('./part.ngc', 0);
    expect(read('fd_read', fd, 3)).toBe('G1 ');
    expect(read('fd_read', fd, 9)).toBe('X5');
    expect(read('fd_read', fd, 9)).toBe('');
    expect(calls['path_filestat_get']!(3, 0, ...put('part.ngc'), 64)).toBe(OK);
    expect(view().getBigUint64(64 + 32, true)).toBe(5n);
    expect(calls['fd_close']!(fd)).toBe(OK);
    expect(calls['fd_close']!(fd)).not.toBe(OK);
  });

  it('has no other files and no folders', () => {
    expect(open('part.ngc', 0)).toBe(-44);
    expect(calls['path_filestat_get']!(3, 0, ...put('part.ngc'), 64)).toBe(44);
    expect(open('part.ngc', CREATE | 2)).toBeLessThan(0);
    expect(calls['fd_prestat_get']!(3, 64)).toBe(OK);
    expect(calls['fd_prestat_get']!(4, 64)).not.toBe(OK);
    expect(calls['sched_yield']!()).toBe(52);
  });

  it('keeps written bytes, also over earlier ones and in large files', () => {
    const fd = open('model', NEW);
    for (let n = 0; n < 100; n += 1) expect(write(fd, 'x'.repeat(2000))).toBe(OK);
    expect(calls['fd_seek']!(fd, 4n, 0, 64)).toBe(OK);
    write(fd, 'abc');
    expect(calls['fd_seek']!(fd, 0n, 2, 64)).toBe(OK);
    expect(view().getBigUint64(64, true)).toBe(200_000n);
    write(fd, 'end');
    const bytes = folder.take('model')!;
    expect(bytes.length).toBe(200_003);
    expect(new TextDecoder().decode(bytes.subarray(2, 9))).toBe('xxabcxx');
    expect(new TextDecoder().decode(bytes.subarray(-4))).toBe('xend');
    expect(folder.take('model')).toBeNull();
  });

  it('lets a file be read that was removed while it was open', () => {
    const writer = open('spool', NEW);
    write(writer, 'triangles');
    const reader = open('spool', 0);
    expect(calls['path_unlink_file']!(3, ...put('spool'))).toBe(OK);
    expect(open('spool', 0)).toBe(-44);
    expect(read('fd_pread', reader, 4, 3n)).toBe('angl');
  });

  it('has a clock, in nanoseconds', () => {
    const now = (): bigint => {
      expect(calls['clock_time_get']!(1, 1000n, 512)).toBe(OK);
      return view().getBigUint64(512, true);
    };
    const clock = vi.spyOn(performance, 'now');
    for (const [ms, ns] of [
      [0, 0n],
      [20.5, 20_500_000n],
      [3.6e6, 3_600_000_000_000n],
    ] as const) {
      clock.mockReturnValue(ms);
      expect(now()).toBe(ns);
    }
    clock.mockRestore();
  });
});
