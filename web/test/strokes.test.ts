// SPDX-License-Identifier: Apache-2.0
import { afterEach, describe, expect, it, vi } from 'vitest';
import { changeStroke, listStrokes } from '../src/link/strokes';
import type { Stroke } from '../src/model/stroke';
import { nextStroke, whyNotUndo } from '../src/model/stroke_choice';

function stroke(id: number, participant: number, undone = false): Stroke {
  return { id, last: id + 4, participant, tool: 1, motions: 5, begin_ms: 1, end_ms: 2, undone };
}

function answer(status: number, body: unknown) {
  const fetched = vi.fn(() => Promise.resolve(new Response(JSON.stringify(body), { status })));
  vi.stubGlobal('fetch', fetched);
  return fetched;
}

afterEach(() => vi.unstubAllGlobals());

describe('strokes', () => {
  it('are listed from a record on, without invalid entries', async () => {
    const strokes = [stroke(1, 3), { id: 'two' }, null, stroke(9, 4, true)];
    const fetched = answer(200, { strokes });
    expect(await listStrokes('a b', 7)).toEqual([stroke(1, 3), stroke(9, 4, true)]);
    expect(fetched).toHaveBeenCalledWith('/v1/sessions/a%20b/strokes?since=7', {
      credentials: 'include',
      method: 'GET',
    });
  });

  it('are changed one by one, and a failure has the reason of the server', async () => {
    const fetched = answer(200, { strokes: [9] });
    await changeStroke('demo', 'undo', 9);
    expect(fetched).toHaveBeenCalledWith('/v1/sessions/demo/undo?strokes=9', {
      credentials: 'include',
      method: 'POST',
    });
    answer(409, { error: { code: 'bad_stroke', reason: 'stroke 9 is undone already' } });
    await expect(changeStroke('demo', 'undo', 9)).rejects.toThrow('stroke 9 is undone already');
    answer(502, 'no JSON object');
    await expect(listStrokes('demo')).rejects.toThrow('the server reported error 502');
  });

  it('undo takes back the newest that stands, redo brings it again', () => {
    const all = [stroke(1, 3), stroke(5, 4), stroke(9, 3)];
    expect(nextStroke(all, 'undo', 3)?.id).toBe(9);
    expect(nextStroke(all, 'undo', null)?.id).toBe(9);
    expect(nextStroke(all, 'undo', 4)?.id).toBe(5);
    expect(nextStroke(all, 'undo', 8)).toBeNull();
    expect(nextStroke(all, 'redo', 3)).toBeNull();
    all[2]!.undone = true;
    expect(nextStroke(all, 'undo', 3)?.id).toBe(1);
    expect(nextStroke(all, 'redo', 3)?.id).toBe(9);
    all[0]!.undone = true;
    expect(nextStroke(all, 'undo', 3)).toBeNull();
    expect(nextStroke(all, 'redo', 3)?.id).toBe(1);
    expect(nextStroke(all, 'redo', 4)).toBeNull();
  });

  it('may be undone by those whose role allows it', () => {
    expect(whyNotUndo({})).toBe(''); // a server without rights
    expect(whyNotUndo({ role: 'sculptor', may: ['watch', 'undo'] })).toBe('');
    expect(whyNotUndo({ role: 'watcher', may: ['watch'] })).toBe(
      'Your role, watcher, does not allow undoing.',
    );
  });
});
