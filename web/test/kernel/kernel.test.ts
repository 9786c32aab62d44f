// SPDX-License-Identifier: Apache-2.0
// kerf.wasm in the page's hands. tests/determinism compares its bytes with the server's kernel.
import { existsSync, readFileSync } from 'node:fs';
import { beforeAll, describe, expect, it } from 'vitest';
import { hashText, Kernel } from '../../src/kernel/kernel';
import { encodeFrame } from '../../src/wire/encode';
import { FrameType, STOCK_RESET } from '../../src/wire/types';
import type { Sample, Vec3 } from '../../src/wire/types';

const FILE = new URL('../../public/kerf.wasm', import.meta.url);
const WELCOME = {
  type: 'welcome',
  stock: { shape: 'box', min_mm: [0, 0, -10], max_mm: [32, 16, 0] },
  accuracy: { rays: 'dexel', pitch_mm: 0.5, tolerance_mm: 0.01, motion: 'tight' },
  tools: [{ id: 1, shape: 'flat', diameter_mm: 6, length_mm: 30 }],
  force: { law: 'specific_energy', specific_force_n_per_mm2: 0.5, drr_n_s_per_mm3: 0.01 },
  limits: { speed_mm_per_s: 5000 },
};
const UNTOUCHED = [0, 1].map((x) => ({ axis: 2, x, y: 0, columns: new Uint8Array() }));

function header(type: number, flags = 0) {
  return { type, flags, epoch: 1, sequence: 1n, time_us: 1n };
}

/** The motion of a tool that cuts from place to place. */
function motion(from: bigint, tips: Vec3[]): Uint8Array {
  const samples = tips.map((tip_mm, n): Sample => {
    const sequence = from + BigInt(n);
    const plain = { axis: [0, 0, 1] as Vec3, tool_id: 1, buttons: 1, felt_share: 0 };
    return { agent_sequence: sequence, time_us: 10_000n * sequence, tip_mm, ...plain };
  });
  return encodeFrame({ header: header(FrameType.Motion), kind: 'motion', samples });
}

function stock(agent_time_us: bigint): Uint8Array {
  const flagged = { reset: true, returned: false, agent_time_us, tiles: UNTOUCHED };
  return encodeFrame({ header: header(FrameType.Stock, STOCK_RESET), kind: 'stock', ...flagged });
}

describe.skipIf(!existsSync(FILE))('kerf.wasm', () => {
  let kernel: Kernel;
  beforeAll(async () => {
    kernel = await Kernel.of(await WebAssembly.compile(readFileSync(FILE)));
  });

  it('cuts the motions of the page, and has the surface that the server has sent', () => {
    kernel.open(JSON.stringify(WELCOME));
    const whole = kernel.hash();
    expect(whole).toMatch(/^[0-9a-f]{16}$/);
    const slot: Vec3[] = [
      [4, 8, -2],
      [12, 8, -2],
    ];
    expect(kernel.take(motion(1n, slot))).toBe(true);
    const cut = kernel.hash();
    expect(cut).not.toBe(whole);
    expect(kernel.changed()).toEqual([]); // the server may have cut there before
    expect(kernel.take(stock(0n))).toBe(true);
    expect(kernel.hash()).toBe(cut);
    expect(kernel.changed()).toEqual([
      { x: 0, y: 0, byPage: true },
      { x: 1, y: 0, byPage: true }, // whose edge has columns of the other
    ]);
    expect(kernel.changed()).toEqual([]);
    const mesh = kernel.mesh(0, 0);
    const heights = new Set<number>();
    for (let n = 2; n < mesh.positions.length; n += 3) heights.add(mesh.positions[n]!);
    // Above the lowest corner: the bottom, the slot and the top.
    for (const height of [0, 8, 10]) expect(heights).toContain(height);
    // All that lies lower than the top and above the bottom, inside, was cut.
    mesh.original.forEach((original, n) => {
      const [x, y, z] = mesh.positions.subarray(3 * n, 3 * n + 3);
      if (z === 8 && x! > 1 && y! > 1 && y! < 15) expect(original).toBe(0);
      if (z === 0) expect(original).toBe(1);
    });
    expect(mesh.normals).toHaveLength(mesh.positions.length);
    expect(Math.max(...mesh.index)).toBe(mesh.positions.length / 3 - 1);
  });

  it('takes back cuts that the server has not made', () => {
    kernel.open(JSON.stringify(WELCOME));
    const whole = kernel.hash();
    kernel.take(stock(0n));
    kernel.take(
      motion(1n, [
        [4, 8, -2],
        [9, 8, -2],
      ]),
    );
    kernel.changed();
    // The server has rejected both samples.
    kernel.take(stock(20_000n));
    expect(kernel.hash()).toBe(whole);
    expect(kernel.changed().map(({ byPage }) => byPage)).toEqual([false]);
  });

  it('shows an undo before the server has it, which the state waits for', () => {
    kernel.open(JSON.stringify(WELCOME));
    kernel.take(stock(0n));
    const slot: Vec3[] = [
      [4, 8, -2],
      [9, 8, -2],
    ];
    kernel.take(motion(1n, slot));
    kernel.changed();
    const cut = kernel.hash();
    const hasFloor = (): boolean => {
      const { positions } = kernel.mesh(0, 0);
      const inside = (n: number): boolean => positions[n - 2]! > 1 && positions[n - 1]! > 1;
      return positions.some((z, n) => n % 3 === 2 && z === 8 && inside(n));
    };
    expect(hasFloor()).toBe(true);
    kernel.change(true);
    expect(kernel.changed().map(({ byPage }) => byPage)).toEqual([true]);
    expect(hasFloor()).toBe(false);
    expect(kernel.hash()).toBe(cut);
    kernel.change(false);
    kernel.changed();
    expect(hasFloor()).toBe(true);
    kernel.change(true);
    kernel.changed();
    kernel.settle(); // the server has refused
    expect(kernel.changed()).toHaveLength(1);
    expect(hasFloor()).toBe(true);
  });

  it('tells the force of the newest motion', () => {
    kernel.open(JSON.stringify(WELCOME));
    kernel.take(stock(0n));
    kernel.take(
      motion(1n, [
        [4, 8, -2],
        [9, 8, -2],
      ]),
    );
    expect(kernel.force()).toBeGreaterThan(0.1);
    // Out of the stock, and farther than the force is spread.
    kernel.take(motion(3n, [[9, 8, 5]]));
    kernel.take(motion(4n, [[9, 8, 9]]));
    expect(kernel.force()).toBe(0);
  });

  it('throws at a welcome that it cannot read', () => {
    expect(() => kernel.open('{"type":"welcome"}')).toThrow();
  });

  it('says why it cannot open a block', async () => {
    const fresh = await Kernel.of(await WebAssembly.compile(readFileSync(FILE)));
    const huge = { shape: 'box', min_mm: [0, 0, -10], max_mm: [3000, 3000, 0] };
    const accuracy = { ...WELCOME.accuracy, pitch_mm: 0.001 };
    const open = (): void => fresh.open(JSON.stringify({ ...WELCOME, stock: huge, accuracy }));
    expect(open).toThrow('the stock needs more than 2^36 columns');
    fresh.open(JSON.stringify(WELCOME));
    expect(fresh.take(stock(0n))).toBe(true);
  });

  it('asks for the stock again after a malformed frame', async () => {
    const fresh = await Kernel.of(await WebAssembly.compile(readFileSync(FILE)));
    fresh.open(JSON.stringify(WELCOME));
    expect(fresh.take(new Uint8Array(7))).toBe(false);
    expect(fresh.take(stock(0n))).toBe(true);
  });
});

describe('a hash', () => {
  it('is written as by the server: 16 digits, without a sign', () => {
    expect(hashText(0xabn)).toBe('00000000000000ab');
    expect(hashText(-1n)).toBe('ffffffffffffffff');
  });
});
