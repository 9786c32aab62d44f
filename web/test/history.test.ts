// SPDX-License-Identifier: Apache-2.0
import { afterEach, describe, expect, it, vi } from 'vitest';
import {
  branch,
  deleteVersion,
  forceCurve,
  listVersions,
  nameVersion,
  renameVersion,
} from '../src/link/history';

function answer(status: number, body: unknown) {
  const fetched = vi.fn(() => Promise.resolve(new Response(JSON.stringify(body), { status })));
  vi.stubGlobal('fetch', fetched);
  return fetched;
}

afterEach(() => vi.unstubAllGlobals());

describe('history', () => {
  it('lists versions by their records, without invalid entries', async () => {
    const version = (name: string, record: number) => ({
      ...{ name, record, time_ms: 5, author: '', may_change: false },
    });
    answer(200, { versions: [version('late', 9), { name: 'none' }, null, version('early', 2)] });
    const names = (await listVersions('demo')).map(({ name }) => name);
    expect(names).toEqual(['early', 'late']);
  });

  it('names the block of a record, or the present one, renames and deletes a name', async () => {
    const fetched = answer(201, {});
    await nameVersion('a b', 'half & half', 7);
    await nameVersion('demo', 'now', null);
    await renameVersion('demo', 'half & half', 'a & b');
    await deleteVersion('demo', 'half & half');
    expect(fetched.mock.calls).toEqual([
      [
        '/v1/sessions/a%20b/versions?name=half%20%26%20half&at=7',
        { credentials: 'include', method: 'POST' },
      ],
      ['/v1/sessions/demo/versions?name=now', { credentials: 'include', method: 'POST' }],
      [
        '/v1/sessions/demo/versions/half%20%26%20half?name=a%20%26%20b',
        { credentials: 'include', method: 'PATCH' },
      ],
      [
        '/v1/sessions/demo/versions/half%20%26%20half',
        { credentials: 'include', method: 'DELETE' },
      ],
    ]);
  });

  it('branches from a record, or from the present', async () => {
    const fetched = answer(201, { id: 'copy' });
    expect(await branch('demo', 12, 'copy')).toBe('copy');
    await branch('demo', null, 'copy');
    expect(fetched.mock.calls).toEqual([
      ['/v1/sessions?from=demo%4012&id=copy', { credentials: 'include', method: 'POST' }],
      ['/v1/sessions?from=demo&id=copy', { credentials: 'include', method: 'POST' }],
    ]);
  });

  it('rejects with the reason of the server', async () => {
    answer(409, { error: { code: 'version_exists', reason: 'the name is taken' } });
    await expect(nameVersion('demo', 'now', 1)).rejects.toThrow('the name is taken');
  });

  it('has columns of equal length of the forces, also of an answer without them', async () => {
    answer(200, {
      first: [1, 5],
      last: [4, 8],
      force_n: { min: [0, 1], mean: [1, 2], max: [3] },
      end_s: [0.5, 1],
      removed_mm3: [7, 8],
      motions: [4, 4],
      peak: {
        tip_mm: [[1, 2, 3]],
        force_n: [
          [4, 5, 6],
          [0, 0, 0],
        ],
        torque_nmm: [[7, 8, 9]],
      },
    });
    const peaks = [{ tipMm: [1, 2, 3], forceN: [4, 5, 6], torqueNmm: [7, 8, 9] }];
    const curve = { first: [1], last: [4], minN: [0], meanN: [1], maxN: [3] };
    const more = { endS: [0.5], removedMm3: [7], motions: [4], peaks };
    expect(await forceCurve('demo', 100)).toEqual({ ...curve, ...more });
    answer(200, {});
    expect(await forceCurve('demo', 100)).toMatchObject({ first: [], peaks: [] });
  });
});
