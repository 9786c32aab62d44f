// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import {
  duration,
  feltBeside,
  figure,
  moment,
  pauseText,
  sentence,
  volume,
} from '../src/ui/format';

describe('format', () => {
  it('keeps three significant digits', () => {
    expect([0, 0.01234, 1.2345, 12.345, 123.45, 123456].map(figure)).toEqual([
      '0',
      '0.0123',
      '1.23',
      '12.3',
      '123',
      '123,456',
    ]);
    expect(volume(999)).toEqual(['999', 'mm³']);
    expect(volume(49666)).toEqual(['49.7', 'cm³']);
  });

  it('shows felt after computed where they differ', () => {
    expect(feltBeside(18.1, 1 / 6, 'N')).toBe('18.1 N · felt 3.02 (× 0.167)');
    expect(feltBeside(18.1, 0, 'N')).toBe('18.1 N · not felt');
    expect(feltBeside(18.1, 0.995, 'N')).toBe('18.1 N');
    expect(feltBeside(18.1, null, 'N')).toBe('18.1 N');
    expect(feltBeside(0, 0, 'N')).toBe('0 N');
  });

  it('says how long ago', () => {
    expect([0, 999, 3400, 59_999, 60_000, 3_599_999, 7_200_000].map(duration)).toEqual([
      '0 s',
      '0 s',
      '3 s',
      '59 s',
      '1 min',
      '59 min',
      '2 h',
    ]);
  });

  it('says when something was, with the day if that is another', () => {
    const noon = new Date(2026, 10, 27, 12, 0, 5).getTime();
    expect(moment(noon - 60_000, noon)).toBe('11:59:05');
    expect(moment(noon - 24 * 3_600_000, noon)).toBe('Nov 26, 2026, 12:00:05');
  });

  it('turns reasons into sentences', () => {
    expect(sentence('no hello within 5 s')).toBe('No hello within 5 s.');
    expect(sentence('All is well.')).toBe('All is well.');
    expect(sentence("my part.ngc:6: 'Q' is unknown")).toBe("my part.ngc:6: 'Q' is unknown.");
    expect(sentence('notes.docx cannot be read')).toBe('notes.docx cannot be read.');
  });
});

describe('pauseText', () => {
  it('says why nothing can be carved', () => {
    expect(pauseText(null)).toBe('');
    expect(pauseText({})).toBe('');
    expect(pauseText({ paused: 'disk' })).toContain('disk is full');
    expect(pauseText({ paused: 'lease' })).toContain('reach each other');
  });
});
