// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { parseControl } from '../src/wire/control';

const welcome = {
  type: 'welcome',
  session: 'demo',
  participant: 3,
  epoch: 1,
  color: '#d9541e',
  pitch_mm: 0.25,
  pivot_mm: 60,
  stock: { shape: 'box', min_mm: [-50, -50, -50], max_mm: [50, 50, 0] },
  tools: [{ id: 1, shape: 'ball', diameter_mm: 10, length_mm: 60 }],
  participants: [{ participant: 1, name: 'Ada', color: '#112233', tool: 1, kind: 'agent' }],
  grid: { origin_mm: [-50, -50, -50], columns: [400, 400], tile: 32 },
};

function parse(value: unknown) {
  return parseControl(JSON.stringify(value));
}

describe('control messages', () => {
  it('parses a welcome', () => {
    expect(parse(welcome)).toEqual({ ok: true, value: welcome });
  });

  it('takes the name of the scene, where there is one', () => {
    const named = { ...welcome, name: 'Bracket op 1' };
    expect(parse(named)).toEqual({ ok: true, value: named });
    expect(parse({ ...welcome, name: '' })).toEqual({ ok: true, value: welcome });
    expect(parse({ ...welcome, name: 7 })).toEqual({ ok: true, value: welcome });
  });

  it('ignores unknown fields and skips unknown types', () => {
    expect(parse({ ...welcome, weather: 'fine' })).toEqual({ ok: true, value: welcome });
    expect(parse({ type: 'weather', fine: true })).toEqual({ ok: true, value: null });
  });

  it.each([
    ['epoch', 'one'],
    ['stock', { shape: 'donut' }],
    ['stock', { shape: 'box', min_mm: [0, 0], max_mm: [1, 1, 1] }],
    ['tools', {}],
    ['tools', [{ shape: 'ball' }]],
    ['participants', [{ participant: 1 }]],
    ['grid', null],
    ['pitch_mm', null],
  ])('rejects a welcome whose %s is %j', (field, value) => {
    const result = parse({ ...welcome, [field]: value });
    expect(result.ok).toBe(false);
    if (!result.ok) expect(result.error.code).toBe('bad_json');
  });

  it('takes the tools of a session when one was made', () => {
    const tools = [{ id: 3, shape: 'ball', diameter_mm: 7, length_mm: 30 }];
    expect(parseControl(JSON.stringify({ type: 'tools', tools }))).toEqual({
      ok: true,
      value: { type: 'tools', tools },
    });
    expect(parseControl('{"type":"tools","tools":[{"id":3}]}').ok).toBe(false);
  });

  it('takes the name of a session that was renamed', () => {
    expect(parseControl('{"type":"name","name":"Owl"}')).toEqual({
      ok: true,
      value: { type: 'name', name: 'Owl' },
    });
    expect(parseControl('{"type":"name"}').ok).toBe(false);
  });

  it('rejects anything but a JSON object', () => {
    for (const text of ['', '{', '[]', 'null', '7', '"welcome"'])
      expect(parseControl(text).ok).toBe(false);
  });

  it('parses changes of the participants, whose lists may be missing', () => {
    const { participants } = welcome;
    const change = { type: 'participants_changed', changed: participants, left: [4], viewers: 60 };
    expect(parse(change)).toEqual({ ok: true, value: change });
    expect(parse({ type: 'participants_changed', viewers: 60 })).toEqual({
      ok: true,
      value: { type: 'participants_changed', changed: [], left: [], viewers: 60 },
    });
    for (const bad of [{ left: ['4'] }, { changed: [{}] }, { viewers: null }])
      expect(parse({ ...change, ...bad }).ok).toBe(false);
    const list = { type: 'participants', participants, viewers: 812 };
    expect(parse(list)).toEqual({ ok: true, value: list });
  });

  it('parses where a device reaches', () => {
    const reach = {
      center_mm: [1, 2, 3],
      half_mm: [60, 50, 40],
      turn_rad: [0, 0, 1.5],
      scale: 0.5,
    };
    const ada = { ...welcome.participants[0]!, reach };
    const list = { type: 'participants', participants: [ada], viewers: 1 };
    expect(parse(list)).toEqual({ ok: true, value: list });
    for (const bad of [7, {}, { ...reach, half_mm: [1, 2] }, { ...reach, turn_rad: [0, 0, null] }])
      expect(parse({ ...list, participants: [{ ...ada, reach: bad }] }).ok).toBe(false);
  });

  it('replaces a color that is not six hexadecimal digits', () => {
    const evil = { ...welcome.participants[0], color: 'red;background:url(//evil)' };
    const result = parse({ type: 'participants', participants: [evil] });
    if (!result.ok || result.value?.type !== 'participants') throw new Error('not read');
    expect(result.value.participants[0]?.color).toMatch(/^#[0-9a-f]{6}$/);
  });

  it('accepts only true as settled', () => {
    const state = {
      type: 'state',
      motions: 1,
      removed_volume_mm3: 2,
      state_hash: '0123456789abcdef',
    };
    expect(parse({ ...state, settled: 1 })).toEqual({
      ok: true,
      value: { ...state, settled: false },
    });
    expect(parse({ ...state, settled: true, paused: 'disk' })).toEqual({
      ok: true,
      value: { ...state, settled: true, paused: 'disk' },
    });
    for (const [word, paused] of [
      ['lease', 'lease'],
      ['tape', 'disk'],
    ]) {
      expect(parse({ ...state, settled: true, paused: word })).toEqual({
        ok: true,
        value: { ...state, settled: true, paused },
      });
    }
    const at = { record: 17, time_ms: 1795356180000, rate: 0.25 };
    expect(parse({ ...state, settled: true, at })).toEqual({
      ok: true,
      value: { ...state, settled: true, at },
    });
    expect(parse({ ...state, settled: true, at: { record: 17 } }).ok).toBe(false);
    expect(parse({ ...state, settled: true })).toEqual({
      ok: true,
      value: { ...state, settled: true },
    });
  });
});
