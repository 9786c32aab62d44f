// SPDX-License-Identifier: Apache-2.0
import { beforeEach, describe, expect, it } from 'vitest';
import { Changes } from '../../src/carve/changes';

describe('the undo of several strokes', () => {
  let asked: string[];
  let ended: boolean[];
  let changes: Changes;

  beforeEach(() => {
    [asked, ended] = [[], []];
    changes = new Changes((undone) => asked.push(undone ? 'undo' : 'redo'));
  });
  const add = (undone: boolean, strokes: number): void =>
    changes.add(undone, strokes, (changed) => ended.push(changed));

  it('asks for one stroke after the other', () => {
    add(true, 2);
    expect([asked, changes.waiting, changes.isBusy]).toEqual([['undo'], 1, true]);
    expect(changes.answered(true)).toBe(false);
    expect([asked, ended]).toEqual([['undo', 'undo'], []]);
    changes.answered(true);
    expect([asked.length, ended, changes.isBusy]).toEqual([2, [true], false]);
  });

  it('puts the strokes back that it has undone when one is rejected, and reports that once', () => {
    add(true, 3);
    changes.answered(true);
    changes.answered(true);
    expect(changes.answered(false)).toBe(true);
    expect(asked).toEqual(['undo', 'undo', 'undo', 'redo']);
    expect(changes.answered(true)).toBe(false);
    changes.answered(true);
    expect([asked.slice(3), ended]).toEqual([['redo', 'redo'], [false]]);
  });

  it('leaves strokes that cannot be put back, and goes on with the next gesture', () => {
    add(true, 2);
    add(false, 1);
    changes.answered(true);
    changes.answered(false);
    expect(changes.answered(false)).toBe(false);
    expect([asked, ended]).toEqual([['undo', 'undo', 'redo', 'redo'], [false]]);
    changes.answered(true);
    expect(ended).toEqual([false, true]);
  });
});
