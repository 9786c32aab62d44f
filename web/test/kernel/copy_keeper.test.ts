// SPDX-License-Identifier: Apache-2.0
import { beforeEach, describe, expect, it } from 'vitest';
import { BlockCopy } from '../../src/kernel/block_copy';
import type { WorkerPort } from '../../src/kernel/block_copy';
import { CopyKeeper } from '../../src/kernel/copy_keeper';
import type { ChangedTile, Kernel, TileTriangles } from '../../src/kernel/kernel';
import type { FromWorker } from '../../src/kernel/messages';
import { tileKey } from '../../src/model/tiles';

const MOTION = new Uint8Array([0, 0, 0, 0, 1]);
const STOCK = new Uint8Array([0, 0, 0, 0, 8]);

/** The smallest module. */
const EMPTY = new WebAssembly.Module(new Uint8Array([0, 0x61, 0x73, 0x6d, 1, 0, 0, 0]));

/** A kernel that changes the tiles that the test sets. */
class FakeKernel {
  next: ChangedTile[] = [];
  accepts = true;
  opened = 0;
  heard: string[] = [];
  change(undone: boolean): void {
    this.heard.push(undone ? 'undo' : 'redo');
  }
  settle(): void {
    this.heard.push('settle');
  }
  open(welcome: string): void {
    if (welcome === '') throw new Error('no stock');
    this.opened += 1;
  }
  take(): boolean {
    return this.accepts;
  }
  changed(): ChangedTile[] {
    return this.next.splice(0);
  }
  mesh(x: number, y: number): TileTriangles {
    const none = {
      normals: new Float32Array(),
      index: new Uint32Array(),
      original: new Uint8Array(),
    };
    return { x, y, positions: new Float32Array(), ...none };
  }
  force(): number {
    return 2.5;
  }
  hash(): string {
    return 'abc';
  }
}

describe('the copy in a worker', () => {
  let kernel: FakeKernel;
  let copy: BlockCopy;
  let log: string[];
  let felt: number[];
  let later: (() => void)[];
  let port: WorkerPort;

  /** Page and worker, whose messages pass at once. */
  function make(
    load: () => Promise<Kernel>,
    module: Promise<WebAssembly.Module | null> = Promise.resolve(EMPTY),
  ): void {
    log = [];
    felt = [];
    later = [];
    port = {
      onmessage: null,
      onerror: null,
      onmessageerror: null,
      postMessage: (message) => receive(message),
    };
    const keeper = new CopyKeeper(
      (data: FromWorker) => port.onmessage!({ data }),
      load,
      (act) => later.push(act),
    );
    const receive = (message: Parameters<WorkerPort['postMessage']>[0]): void => {
      void keeper.receive(message);
    };
    copy = new BlockCopy(module, port, {
      tiles: (tiles, newest) =>
        log.push(`tiles ${tiles.map(({ x, y }) => `${x},${y}`).join(' ')} to ${newest}`),
      felt: (forceN) => felt.push(forceN),
      changes: () => log.push('changes'),
      lacks: () => log.push('lacks'),
      failed: (reason) => log.push(`failed ${reason}`),
    });
  }

  function rest(): void {
    for (const act of later.splice(0)) act();
  }

  beforeEach(async () => {
    kernel = new FakeKernel();
    make(() => Promise.resolve(kernel as unknown as Kernel));
    expect(await copy.isThere).toBe(true);
    copy.open('{}');
  });

  it('forgets displayed and waiting tiles when another block opens', () => {
    copy.cut(MOTION, 3n);
    kernel.next = [{ x: 1, y: 2, byPage: true }];
    rest(); // 1,2 is displayed from the copy
    copy.cut(MOTION, 4n);
    kernel.next = [{ x: 5, y: 5, byPage: true }];
    copy.take(STOCK); // 5,5 is to be meshed
    copy.open('{}');
    log.length = 0;
    kernel.next = [{ x: 1, y: 2, byPage: false }]; // of the new block, cut by another
    copy.cut(MOTION, 5n);
    rest();
    expect(log).toEqual([]);
  });

  it("meshes the page's cuts, many motions at once", () => {
    copy.cut(MOTION, 3n);
    copy.cut(MOTION, 4n);
    kernel.next = [{ x: 1, y: 2, byPage: true }];
    expect(log).toEqual([]);
    rest();
    expect(log).toEqual(['tiles 1,2 to 4']);
    rest();
    expect(log).toHaveLength(1);
  });

  it("reports the force of the page's cut at once", () => {
    copy.take(STOCK);
    expect(felt).toEqual([]);
    copy.cut(MOTION, 3n);
    expect(felt).toEqual([2.5]);
  });

  it("meshes other participants' cuts only where the page displays its own tiles", () => {
    kernel.next = [{ x: 1, y: 2, byPage: false }];
    copy.take(STOCK);
    rest();
    expect(log).toEqual([]);
    copy.cut(MOTION, 5n);
    kernel.next = [{ x: 1, y: 2, byPage: true }];
    rest();
    kernel.next = [
      { x: 1, y: 2, byPage: false },
      { x: 7, y: 2, byPage: false },
    ];
    copy.take(STOCK);
    rest();
    expect(log).toEqual(['tiles 1,2 to 5', 'tiles 1,2 to 5']);
    copy.hidden([tileKey(1, 2)]);
    kernel.next = [{ x: 1, y: 2, byPage: false }];
    copy.take(STOCK);
    rest();
    expect(log).toHaveLength(2);
  });

  it('meshes the change of an undo before the server has it', () => {
    copy.change(true);
    kernel.next = [{ x: 1, y: 2, byPage: true }];
    rest();
    copy.change(false);
    copy.settle();
    kernel.next = [
      { x: 1, y: 2, byPage: false },
      { x: 7, y: 2, byPage: false },
    ];
    rest();
    expect(log).toEqual(['changes', 'tiles 1,2 to 0', 'changes', 'tiles 1,2 to 0']);
    expect(kernel.heard).toEqual(['undo', 'redo', 'settle']);
  });

  it('asks for the stock when it is wrong, and tells its hash', async () => {
    kernel.accepts = false;
    copy.take(STOCK);
    expect(log).toEqual(['lacks']);
    expect(await copy.hash()).toBe('abc');
  });

  it('ends when the kernel does', async () => {
    copy.open('');
    expect(log).toEqual(['failed no stock']);
    expect(copy.works).toBe(false);
    copy.cut(MOTION, 1n);
    expect(later).toEqual([]);
    expect(await copy.hash()).toBeNull();
  });

  it('is not there where its worker does not load', async () => {
    const never = new Promise<never>(() => undefined);
    make(() => never);
    port.onerror!({});
    expect(await copy.isThere).toBe(false);
    make(() => never);
    port.onmessageerror!();
    expect(await copy.isThere).toBe(false);
    expect(log).toEqual(['failed A message of its worker cannot be read.']);
  });

  it('ends when its worker does', async () => {
    port.postMessage = () => undefined;
    const hash = copy.hash(); // which nobody answers
    port.onerror!({ message: 'out of memory' });
    expect(await hash).toBeNull();
    expect([copy.works, log]).toEqual([false, ['failed out of memory']]);
  });

  it('is not there without kerf.wasm, or where that does not run', async () => {
    const load = (): Promise<Kernel> => Promise.reject(new Error('no memory'));
    make(load, Promise.resolve(null));
    expect(await copy.isThere).toBe(false);
    expect(log).toEqual([]);
    make(load, Promise.reject(new Error('no SIMD')));
    expect(await copy.isThere).toBe(false);
    expect(log).toEqual(['failed no SIMD']);
    make(load);
    expect(await copy.isThere).toBe(false);
    expect(log).toEqual(['failed no memory']);
    expect(kernel.opened).toBe(1);
  });
});
