// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { asRead, NO_FILES, placeOfError, withFiles } from '../../src/local/given_files';

const file = (name: string) => ({ name, bytes: new Uint8Array() });

describe('the files that a user gives', () => {
  it('are program, subroutines, scene and stock by their names', () => {
    const files = withFiles(NO_FILES, ['a.NGC', 'sub.ngc', 's.json', 'part.STL'].map(file));
    expect(files.program?.name).toBe('a.NGC');
    expect(files.others.map(({ name }) => name)).toEqual(['sub.ngc']);
    expect(files.scene?.name).toBe('s.json');
    expect(files.stock?.name).toBe('part.STL');
  });

  it('take the place of those before: a program that of a program and its subroutines', () => {
    const before = withFiles(NO_FILES, ['a.ngc', 'sub.ngc', 's.json'].map(file));
    const files = withFiles(before, [file('b.h')]);
    expect(files.program?.name).toBe('b.h');
    expect(files.others).toEqual([]);
    expect(files.scene?.name).toBe('s.json');
    expect(withFiles(files, [file('t.json')]).program?.name).toBe('b.h');
  });

  it('take the place of a journal, and a journal that of all', () => {
    const before = withFiles(NO_FILES, ['a.ngc', 's.json', 'p.stl'].map(file));
    const journal = withFiles(before, [file('Block.KERF')]);
    expect(journal).toEqual({ ...NO_FILES, journal: file('Block.KERF') });
    expect(withFiles(journal, [file('a.ngc')])).toEqual({ ...NO_FILES, program: file('a.ngc') });
  });

  it('have a model as stock unless a scene names its stock', () => {
    const without = withFiles(NO_FILES, ['a.ngc', 'p.stl'].map(file));
    expect(asRead(without).stock?.name).toBe('p.stl');
    const read = asRead(withFiles(without, [file('s.json')]));
    expect(read.stock).toBeNull();
    expect(read.others.map(({ name }) => name)).toEqual(['p.stl']);
  });
});

describe('an error of a program', () => {
  it('has the line and the word that kerf-carve names', () => {
    const reason = "a b.ngc:12: 'P12' must be an integer (read as LinuxCNC)";
    expect(placeOfError('a b.ngc', reason)).toEqual({ line: 12, word: 'P12' });
    expect(placeOfError('a b.ngc', 'a b.ngc:3: the feed is 0')).toEqual({ line: 3, word: '' });
  });

  it('has no place in the text if it is of another file or of the whole', () => {
    expect(placeOfError('a.ngc', "b.ngc:3: 'Q' is unknown")).toBeNull();
    expect(placeOfError('a.ngc', 'a.ngc: cuts nothing')).toBeNull();
  });
});
