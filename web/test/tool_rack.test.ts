// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { ToolRack } from '../src/ui/tools/tool_rack';
import type { ToolInfo } from '../src/wire/types';
import { FakeElement, stubPage } from './support/fake_dom';

const BALL: ToolInfo = { id: 1, shape: 'ball', diameter_mm: 6, length_mm: 30 };
const FLAT: ToolInfo = { id: 4, shape: 'flat', diameter_mm: 8, length_mm: 30 };

describe('the tools of a new block', () => {
  let rack: ToolRack;
  let changes: number;

  beforeEach(() => {
    stubPage();
    Object.assign(document, {
      createElementNS: (_space: string, tag: string) => new FakeElement(tag),
    });
    changes = 0;
    rack = new ToolRack([BALL, FLAT], () => (changes += 1));
  });
  afterEach(() => vi.unstubAllGlobals());

  /** All elements below one, in order. */
  function below(element: FakeElement): FakeElement[] {
    return element.children.flatMap((child) => [child, ...below(child)]);
  }
  function labelled(label: string): FakeElement {
    const all = below(rack.element as unknown as FakeElement);
    const found = all.find((one) => one.getAttribute('aria-label') === label);
    if (!found) throw new Error(`nothing is called ${label}`);
    return found;
  }
  const addTool = (): void =>
    below(rack.element as unknown as FakeElement)
      .find((one) => one.textContent === 'Add a tool')!
      .click();
  function enter(label: string, value: number): void {
    const input = labelled(`${label}, mm`);
    input.value = String(value);
    input.dispatch('input');
  }

  it('get a ball end mill with an id of its own', () => {
    addTool();
    expect(rack.tools.map(({ id, shape }) => [id, shape])).toEqual([
      [1, 'ball'],
      [4, 'flat'],
      [5, 'ball'],
    ]);
    expect(changes).toBe(1);
    expect(labelled('Outline of T5, ball 6 mm').getAttribute('aria-pressed')).toBe('true');
  });

  it('get an outline by numbers, with a point more and a line in place of the arc', () => {
    addTool();
    labelled('Add a point before point 3').click();
    const edge = labelled('Line or arc to point 2');
    edge.value = 'line';
    edge.dispatch('change');
    const outline = [
      [0, 0],
      [5, 0],
      [3, 4],
      [3, 30],
    ] as const;
    outline.forEach(([r, z], n) => {
      enter(`Radius of point ${n + 1}`, r);
      enter(`Height of point ${n + 1}`, z);
    });
    expect(rack.tools.at(-1)).toEqual({ id: 5, shape: 'profile', profile_mm: outline });
    labelled('Remove point 3').click();
    expect(rack.tools.at(-1)!.profile_mm).toHaveLength(3);
  });

  it('keep the last valid entry where a number is invalid', () => {
    labelled('Outline of T4, flat 8 mm').click();
    const before = changes;
    enter('Radius of point 2', Number.NaN);
    expect(changes).toBe(before);
    expect(rack.tools[1]).toEqual(FLAT);
  });

  it('go, with their outline, but for the last one', () => {
    labelled('Outline of T1, ball 6 mm').click();
    expect(labelled('Radius of point 1, mm').value).toBe('0');
    labelled('Remove T1, ball 6 mm').click();
    expect(rack.tools).toEqual([FLAT]);
    expect(() => labelled('Radius of point 1, mm')).toThrow('nothing is called');
    expect(labelled('Remove T4, flat 8 mm').disabled).toBe(true);
  });

  it('have no outline to edit where arcs are at odd places', () => {
    rack = new ToolRack([{ ...BALL, shape: 'taper', half_angle_deg: 3 }, FLAT], () => undefined);
    expect(labelled('Outline of T1, taper 6 mm').disabled).toBe(true);
    expect(labelled('Outline of T4, flat 8 mm').disabled).toBe(false);
  });
});
