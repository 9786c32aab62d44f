// SPDX-License-Identifier: Apache-2.0
import { readFileSync } from 'node:fs';
import { effect } from '@preact/signals';
import { describe, expect, it } from 'vitest';
import { LineIndex, rowsInView } from '../src/model/line_index';
import { isOpen, Programs, wallSeconds } from '../src/model/programs';
import { SessionModel } from '../src/model/session';
import { uploadName } from '../src/ui/programs/requests';
import { alarmText, duration, stateText } from '../src/ui/programs/texts';
import { parseControl } from '../src/wire/control';
import type { ProgramInfo, ProgramState } from '../src/wire/types';

const GOLDEN = readFileSync(
  new URL('../../tests/wire/golden/programs.json', import.meta.url),
  'utf8',
);

function golden(): ProgramInfo[] {
  const parsed = parseControl(GOLDEN);
  if (!parsed.ok || parsed.value?.type !== 'programs') throw new Error('not a programs message');
  return parsed.value.programs;
}

function program(id: number, state: ProgramState, more: Partial<ProgramInfo> = {}): ProgramInfo {
  return { ...golden()[0]!, id, state, ...more };
}

function ids(programs: Programs): number[] {
  return programs.all().map((one) => one.id);
}

describe('the message on programs', () => {
  it('is read as the server writes it', () => {
    const [running, queued, failed] = golden();
    expect(running).toMatchObject({
      id: 3,
      state: 'running',
      speed: 2.5,
      line: 41,
      alarm_count: 1,
    });
    expect(queued).toMatchObject({ id: 4, state: 'queued', after: 3, pace: 'fast' });
    expect(queued).not.toHaveProperty('speed');
    expect(failed).toMatchObject({ state: 'failed', error: 'old.ngc:9: too far' });
  });

  it('is rejected without a field that the page uses', () => {
    for (const field of ['id', 'name', 'state', 'line', 'remaining_s', 'alarm_count']) {
      const broken = JSON.stringify({
        type: 'programs',
        programs: [{ ...golden()[0], [field]: null }],
      });
      expect(parseControl(broken).ok, field).toBe(false);
    }
  });

  it('may name states of later versions', () => {
    const later = { type: 'programs', programs: [{ ...golden()[0], state: 'dreaming' }] };
    const parsed = parseControl(JSON.stringify(later));
    expect(parsed.ok && parsed.value).toMatchObject({ programs: [{ state: 'unknown' }] });
  });
});

describe('the programs of a session', () => {
  it('are listed with those that have not ended first', () => {
    const programs = new Programs();
    programs.apply([program(1, 'finished'), program(2, 'failed'), program(3, 'paused')]);
    programs.apply([program(3, 'running'), program(4, 'queued'), program(2, 'failed')]);
    expect(ids(programs)).toEqual([3, 4, 2, 1]);
    expect(programs.get(3)?.state).toBe('running');
    expect(programs.incomplete).toBe(false);
  });

  it('are asked for when one has ended unseen', () => {
    const programs = new Programs();
    programs.apply([program(1, 'running'), program(2, 'running')]);
    programs.apply([program(2, 'running')]);
    expect(programs.incomplete).toBe(true);
    expect(ids(programs)).toEqual([2]);
    programs.add([program(1, 'finished')]);
    expect(ids(programs)).toEqual([2, 1]);
  });

  it('do not come back to life by an answer that came late', () => {
    const programs = new Programs();
    programs.apply([program(1, 'cancelled')]);
    programs.add([program(1, 'running')]);
    expect(programs.get(1)?.state).toBe('cancelled');
  });

  it('are forgotten when the connection is a new one', () => {
    const model = new SessionModel();
    model.apply({ type: 'programs', programs: golden() });
    expect(ids(model.programs)).toEqual([3, 4, 2]);
    const seen: number[][] = [];
    effect(() => void seen.push(ids(model.programs)));
    model.programs.clear();
    expect(seen).toEqual([[3, 4, 2], []]);
  });

  it('have a remaining time by the clock at feed rate only', () => {
    expect(wallSeconds(program(1, 'running', { speed: 4, remaining_s: 60 }))).toBe(15);
    expect(wallSeconds(program(1, 'running', { pace: 'fast' }))).toBeNaN();
    expect(isOpen(program(1, 'queued')) && isOpen(program(1, 'paused'))).toBe(true);
    expect(isOpen(program(1, 'finished'))).toBe(false);
  });
});

describe('a text by its lines', () => {
  it.each(['', 'a', 'a\n', '\n', 'a\n\nb', 'G1 X1\r\nG1 X2\r\n', '\n\n'])(
    'has the lines of %j',
    (text) => {
      const expected = text.replace(/\n$/, '').split('\n');
      const lines = new LineIndex(text);
      expect(lines.count).toBe(expected.length);
      expected.forEach((line, n) => expect(lines.line(n + 1)).toBe(line.replace(/\r$/, '')));
      expect(lines.line(0)).toBe('');
      expect(lines.line(expected.length + 1)).toBe('');
    },
  );

  it('may have half a million lines', () => {
    const lines = new LineIndex(
      Array.from({ length: 500_000 }, (_, n) => `N${n + 1} G1`).join('\n'),
    );
    expect(lines.count).toBe(500_000);
    expect(lines.line(499_999)).toBe('N499999 G1');
  });
});

describe('the rows in view', () => {
  it('are those that overlap the window, and some more', () => {
    expect(rowsInView(0, 100, 20, 1000, 0)).toEqual({ first: 0, past: 5 });
    expect(rowsInView(30, 100, 20, 1000, 0)).toEqual({ first: 1, past: 7 });
    expect(rowsInView(30, 100, 20, 1000, 8)).toEqual({ first: 0, past: 15 });
    expect(rowsInView(19_990, 100, 20, 1000, 2)).toEqual({ first: 997, past: 1000 });
    expect(rowsInView(50_000, 100, 20, 10, 2)).toEqual({ first: 10, past: 10 });
  });
});

describe('the sentences', () => {
  it('name the state of a program', () => {
    const [running, queued, failed] = golden();
    expect(stateText(running!)).toBe('running, 24 s left');
    expect(stateText(queued!)).toBe('waiting for program 3');
    expect(stateText(failed!)).toBe('failed: old.ngc:9: too far');
    expect(stateText(program(1, 'running', { waiting: true }))).toContain('disk');
  });

  it('state durations', () => {
    expect([4, 75, 3700, Number.NaN].map(duration)).toEqual(['4 s', '1:15', '1:01:40', '–']);
  });

  it('state where an alarm is', () => {
    const alarm = {
      kind: 'rapid',
      fromLine: 14,
      toLine: 18,
      tool: 1,
      amount: 1.234,
      limit: 0.025,
      unit: 'mm',
      place: [1, -2.04, 0] as [number, number, number],
    };
    expect(alarmText(alarm)).toBe(
      'Rapid move through material, 1.23 mm, limit 0.025: lines 14–18, at X 1.0 Y -2.0 Z 0.0',
    );
    expect(alarmText({ ...alarm, toLine: 14 })).toContain(': line 14,');
  });

  it('keep the extension of a long file name', () => {
    expect(uploadName('part.ngc')).toBe('part.ngc');
    expect(uploadName('a/b\\c.apt')).toBe('a_b_c.apt');
    const long = uploadName(`${'ü'.repeat(80)}.tap`);
    expect(long.endsWith('ü.tap')).toBe(true);
    expect(new TextEncoder().encode(long).length).toBeLessThanOrEqual(64);
    expect(uploadName(`a.${'b'.repeat(80)}`)).toHaveLength(64);
  });
});
