// SPDX-License-Identifier: Apache-2.0
import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { headlineOf, namesOf } from '../src/model/headline';
import { Newcomers } from '../src/model/newcomers';
import { placeOf } from '../src/model/pin_place';
import { SessionModel } from '../src/model/session';
import { parseControl } from '../src/wire/control';
import type { Pin, ProgramInfo, Welcome } from '../src/wire/types';
import { boxPiece } from './support/solids';

const PIN: Pin = {
  pin: 1,
  text: 'deeper here?',
  at_mm: [1, 2, 0],
  normal: [0, 0, 1],
  author: 'Ada',
  created_ms: 1000,
};
const CAMERA = {
  participant: 7,
  name: 'Grace',
  color: '#112233',
  eye_mm: [1, 2, 3],
  target_mm: [0, 0, 0],
  parallel: true,
};
const WELCOME: Welcome = {
  type: 'welcome',
  session: 'wall',
  name: 'Wall',
  participant: 9,
  epoch: 1,
  color: '#112233',
  pitch_mm: 0.5,
  pivot_mm: 60,
  stock: { shape: 'box', min_mm: [0, 0, 0], max_mm: [1, 1, 1] },
  tools: [{ id: 1, shape: 'ball', diameter_mm: 6, length_mm: 30 }],
  participants: [],
  grid: { origin_mm: [0, 0, 0], columns: [2, 2], tile: 32 },
};

function program(more: Partial<ProgramInfo> = {}): ProgramInfo {
  const file = new URL('../../tests/wire/golden/programs.json', import.meta.url);
  const parsed = parseControl(readFileSync(file, 'utf8'));
  if (!parsed.ok || parsed.value?.type !== 'programs') throw new Error('not programs');
  return { ...parsed.value.programs[0]!, ...more };
}

/** A session with agents of these names, of which those in `moving` have just moved. */
function sessionOf(names: readonly string[], moving: readonly string[]): SessionModel {
  const model = new SessionModel();
  model.apply({
    ...WELCOME,
    participants: names.map((name, n) => ({
      participant: n + 1,
      name,
      color: '#112233',
      kind: 'agent',
      tool: 1,
    })),
  });
  for (const one of model.participants.carvers())
    if (moving.includes(one.info.name)) one.seenMs = 1000;
  return model;
}

function sentence(model: SessionModel): string {
  const { who, far } = headlineOf(model, 'wall', 2000);
  return `${who}|${far}`;
}

describe('messages on pins and cameras', () => {
  it('are read, and replace those before', () => {
    const model = new SessionModel();
    for (const message of [
      { type: 'pins', pins: [PIN, { ...PIN, pin: 2 }] },
      { type: 'pins', pins: [PIN] },
      { type: 'cameras', cameras: [CAMERA] },
    ]) {
      const parsed = parseControl(JSON.stringify(message));
      if (parsed.ok && parsed.value) model.apply(parsed.value);
    }
    expect(model.together.pins).toEqual([PIN]);
    expect(model.together.cameras).toEqual([CAMERA]);
    model.apply(WELCOME);
    expect(model.together.pins).toEqual([]);
    expect(model.together.cameras).toEqual([]);
  });

  it.each([
    { type: 'pins', pins: [{ ...PIN, at_mm: [1, 2] }] },
    { type: 'pins', pins: [{ ...PIN, text: 7 }] },
    { type: 'cameras', cameras: [{ ...CAMERA, target_mm: null }] },
  ])('are rejected without what the page uses: %j', (message) => {
    expect(parseControl(JSON.stringify(message)).ok).toBe(false);
  });
});

describe('a pin', () => {
  it('is where the surface is now, above or below', () => {
    expect(placeOf(PIN, [boxPiece([-5, -5, -8], [5, 5, 0])])).toEqual([1, 2, 0]);
    expect(placeOf(PIN, [boxPiece([-5, -5, -8], [5, 5, -3])])).toEqual([1, 2, -3]);
    expect(placeOf(PIN, [boxPiece([-5, -5, -8], [5, 5, 2])])).toEqual([1, 2, 2]);
  });

  it('is on the nearest of several surfaces, where material ends', () => {
    const layers = [boxPiece([-5, -5, -8], [5, 5, -6]), boxPiece([-5, -5, 3], [5, 5, 5])];
    expect(placeOf(PIN, layers)).toEqual([1, 2, 5]);
  });

  it('stays where it was set if nothing is left on its normal', () => {
    expect(placeOf(PIN, [boxPiece([3, 3, -8], [5, 5, 0])])).toEqual([1, 2, 0]);
  });
});

describe('the headline', () => {
  it('lists two names and counts the others', () => {
    expect(namesOf([])).toBe('');
    expect(namesOf(['Ada'])).toBe('Ada');
    expect(namesOf(['Ada', 'Grace'])).toBe('Ada and Grace');
    expect(namesOf(['Ada', 'Grace', 'Bo'])).toBe('Ada, Grace and 1 other');
    expect(namesOf(['Ada', 'Grace', 'Bo', 'Cy'])).toBe('Ada, Grace and 2 others');
  });

  it('names the carvers, the block, and the tool if there is one carver', () => {
    expect(sentence(sessionOf([], []))).toBe('|');
    expect(sentence(sessionOf(['Ada'], ['Ada']))).toBe('Ada carves Wall · ball 6 mm|');
    expect(sentence(sessionOf(['Ada', 'Bo'], ['Ada', 'Bo']))).toBe('Ada and Bo carve Wall|');
    expect(sentence(sessionOf(['Ada', 'Bo'], ['Bo']))).toBe('Bo carves Wall · ball 6 mm|');
    expect(sentence(sessionOf(['Ada', 'Bo'], []))).toBe('Ada and Bo are here but not carving|');
  });

  it('says how far the only running program is', () => {
    const farWith = (...programs: ProgramInfo[]): string => {
      const model = sessionOf([], []);
      model.apply({ type: 'programs', programs });
      return headlineOf(model, 'wall', 0).far;
    };
    const timed = { pace: 'feed', programmed_s: 200, elapsed_s: 123, remaining_s: 77 } as const;
    expect(farWith(program({ ...timed, speed: 1 }))).toBe('61 %, 1:17 left');
    expect(farWith(program({ ...timed, speed: 2 }))).toBe('61 %, 0:39 left');
    expect(farWith(program({ ...timed, state: 'paused' }))).toBe('61 %, paused');
    expect(farWith(program({ pace: 'fast', motions_done: 1, motions: 3 }))).toBe('33 %');
    expect(farWith(program({ state: 'finished' }))).toBe('');
    expect(farWith(program({ id: 1 }), program({ id: 2 }))).toBe('');
  });
});

describe('the newcomer', () => {
  it('is the newest participant, for some seconds; never an earlier one, nor oneself', () => {
    const newcomers = new Newcomers();
    const present = (...names: string[]) => sessionOf(names, []).participants.all();
    const update = (names: string[], nowMs: number): string =>
      newcomers.update(present(...names), ({ info }) => info.name === 'Me', nowMs);
    expect(update([], 0)).toBe('');
    expect(update(['Ada', 'Bo'], 1000)).toBe('');
    expect(update(['Ada', 'Bo', 'Cy'], 2000)).toBe('Cy');
    expect(update(['Ada', 'Bo', 'Cy'], 7900)).toBe('Cy');
    expect(update(['Ada', 'Bo', 'Cy'], 8100)).toBe('');
    expect(update(['Ada', 'Bo', 'Cy', 'Me'], 9000)).toBe('');
  });
});
