// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import type { SessionSummary } from '../src/link/api';
import { freeName } from '../src/model/new_block';
import { shownSessions } from '../src/ui/lobby/card_order';

const session = (name: string, activeMs: number | null): SessionSummary => ({
  ...{ id: name, name, activeMs },
  ...{ motions: 0, removedVolumeMm3: 0, participants: 0, mayRename: false, mayClose: false },
});
const ALL = [session('Relief 10', 1), session('relief 2', 3), session('Bust', null)];
const namesOf = (sessions: readonly SessionSummary[]): string[] => sessions.map(({ name }) => name);

describe('the sessions that the lobby shows', () => {
  it('are those that changed last first, or by name with numbers in their order', () => {
    expect(namesOf(shownSessions(ALL, '', 'active'))).toEqual(['relief 2', 'Relief 10', 'Bust']);
    expect(namesOf(shownSessions(ALL, '', 'name'))).toEqual(['Bust', 'relief 2', 'Relief 10']);
  });

  it('are those whose name has the text, in any case', () => {
    expect(namesOf(shownSessions(ALL, ' RELIEF', 'name'))).toEqual(['relief 2', 'Relief 10']);
    expect(shownSessions(ALL, 'cube', 'name')).toEqual([]);
  });

  it('leaves the given list as it is', () => {
    shownSessions(ALL, '', 'name');
    expect(ALL[0]!.name).toBe('Relief 10');
  });
});

describe('the name of a new block', () => {
  it.each([
    ['Relief', [], 'Relief'],
    ['Relief', ['Bust'], 'Relief'],
    ['Relief', ['relief '], 'Relief 2'],
    ['Relief', ['Relief', 'Relief 2', 'Relief 4'], 'Relief 3'],
  ])('%s next to %j is %s', (name, taken, free) => {
    expect(freeName(name, taken)).toBe(free);
  });
});
