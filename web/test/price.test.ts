// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { priceOf } from '../src/link/lobby_requests';
import { NewBlock } from '../src/ui/lobby/new_block_state';

const ANSWER = { bytes: 5, us_per_motion: 40, join_s: 0.1, motions: 7 };
const DERIVED = { scene: { name: 'Part', tools: [] }, provenance: [] };

describe('the price of a new block', () => {
  let asked: [string, string][];

  beforeEach(() => {
    asked = [];
    vi.stubGlobal('fetch', (address: string, { body }: { body: string }) => {
      asked.push([address, body]);
      const answer = address.startsWith('/v1/programs') ? DERIVED : ANSWER;
      return Promise.resolve({ ok: true, json: () => Promise.resolve(answer) });
    });
  });
  afterEach(() => vi.unstubAllGlobals());

  it('is that of the motions of a dropped program, of a scene that of those of a hand', async () => {
    const scene = { name: 'Part' };
    const hand = { bytes: 5, usPerMotion: 40, joinS: 0.1 };
    expect(await priceOf(scene)).toEqual(hand);
    const program = { name: 'a b.ngc', text: 'G1 X1\n' };
    expect(await priceOf(scene, program)).toEqual({ ...hand, motions: 7 });
    expect(asked).toEqual([
      ['/v1/sessions?dry_run=1', '{"name":"Part"}'],
      ['/v1/prices?name=a%20b.ngc', '{"scene":{"name":"Part"},"program":"G1 X1\\n"}'],
    ]);
  });

  it('is asked for with a program that is dropped, and again at another accuracy', async () => {
    const block = new NewBlock([], () => []);
    await block.read(new File(['G1 X1\n'], 'a b.ngc'));
    block.accuracy.targetMm.value = 0.5;
    await vi.waitFor(() => expect(block.accuracy.price.value).toMatch(/^0.5\u00a0mm: .* to carve/));
    const [, ...prices] = asked;
    expect(prices.map(([address]) => address)).toEqual(Array(2).fill('/v1/prices?name=a%20b.ngc'));
    for (const [, body] of prices) expect(JSON.parse(body)).toMatchObject({ program: 'G1 X1\n' });
    block.choose({ title: 'Plate', scene: { name: 'Plate', tools: [] } } as never);
    expect(asked.at(-1)![0]).toBe('/v1/sessions?dry_run=1');
  });
});
