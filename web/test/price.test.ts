// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, test, vi } from 'vitest';
import { priceOf } from '../src/link/lobby_requests';

afterEach(() => vi.unstubAllGlobals());

test('a dropped program is priced by its own motions, a scene by those of a hand', async () => {
  const asked: [string, string][] = [];
  vi.stubGlobal('fetch', (address: string, { body }: { body: string }) => {
    asked.push([address, body]);
    const answer = { bytes: 5, us_per_motion: 40, join_s: 0.1, motions: 7 };
    return Promise.resolve({ ok: true, json: () => Promise.resolve(answer) });
  });
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
