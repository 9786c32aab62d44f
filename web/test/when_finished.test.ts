// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import golden from '../../tests/wire/golden/programs.json';
import { Programs } from '../src/model/programs';
import { whenFinished } from '../src/ui/programs/when_finished';
import type { ProgramInfo } from '../src/wire/types';
import { turn } from './support/turn';

const PROGRAM = golden.programs[0] as unknown as ProgramInfo;

function program(id: number, state: string): ProgramInfo {
  return { ...PROGRAM, id, state } as ProgramInfo;
}

describe('the end of the first program', () => {
  let listed: ProgramInfo[];
  let ended: number[];
  let programs: Programs;

  beforeEach(() => {
    listed = [];
    ended = [];
    programs = new Programs();
    vi.stubGlobal('fetch', () =>
      Promise.resolve({ ok: true, json: () => Promise.resolve({ programs: listed }) }),
    );
  });
  afterEach(() => vi.unstubAllGlobals());

  function begin(): Promise<unknown> {
    whenFinished(programs, 'demo', (one) => ended.push(one.id));
    return turn();
  }

  it('is told once', async () => {
    await begin();
    programs.apply([program(1, 'running'), program(2, 'queued')]);
    expect(ended).toEqual([]);
    programs.apply([program(1, 'finished'), program(2, 'running')]);
    programs.apply([program(1, 'finished'), program(2, 'finished')]);
    expect(ended).toEqual([1]);
  });

  it('is told if the program ended before the page was there', async () => {
    listed = [program(1, 'finished')];
    await begin();
    expect(ended).toEqual([1]);
  });

  it('is not told of a program that was cancelled', async () => {
    await begin();
    programs.apply([program(1, 'cancelled'), program(2, 'finished')]);
    expect(ended).toEqual([]);
  });
});
