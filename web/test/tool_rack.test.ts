// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { h } from 'preact';
import { beforeEach, describe, expect, it } from 'vitest';
import { ToolRack, ToolRackView } from '../src/ui/tools/tool_rack';
import type { ToolInfo } from '../src/wire/types';
import { buttonOf, enter, labelled, press, show } from './support/shown';

const BALL: ToolInfo = { id: 1, shape: 'ball', diameter_mm: 6, length_mm: 30 };
const FLAT: ToolInfo = { id: 4, shape: 'flat', diameter_mm: 8, length_mm: 30 };

describe('the tools of a new block', () => {
  let rack: ToolRack;
  let root: HTMLElement;

  function open(...tools: ToolInfo[]): void {
    rack = new ToolRack(tools);
    root = show(h(ToolRackView, { rack }));
  }
  beforeEach(() => open(BALL, FLAT));

  const button = (label: string): HTMLButtonElement => labelled(root, label) as HTMLButtonElement;
  const addTool = (): Promise<void> => press(buttonOf(root, 'Add a tool'));
  const enterMm = (label: string, value: number | ''): Promise<void> =>
    enter(labelled(root, `${label}, mm`) as HTMLInputElement, String(value));

  it('get a ball end mill with an id of its own', async () => {
    await addTool();
    expect(rack.tools.map(({ id, shape }) => [id, shape])).toEqual([
      [1, 'ball'],
      [4, 'flat'],
      [5, 'ball'],
    ]);
    expect(button('Outline of T5, ball 6 mm').getAttribute('aria-pressed')).toBe('true');
  });

  it('get an outline by numbers, with a point more and a line in place of the arc', async () => {
    await addTool();
    await press(button('Add a point before point 3'));
    await enter(labelled(root, 'Line or arc to point 2') as HTMLSelectElement, 'line');
    const outline = [
      [0, 0],
      [5, 0],
      [3, 4],
      [3, 30],
    ] as const;
    for (const [n, [r, z]] of outline.entries()) {
      await enterMm(`Radius of point ${n + 1}`, r);
      await enterMm(`Height of point ${n + 1}`, z);
    }
    expect(rack.tools.at(-1)).toEqual({ id: 5, shape: 'profile', profile_mm: outline });
    await press(button('Remove point 3'));
    expect(rack.tools.at(-1)!.profile_mm).toHaveLength(3);
  });

  it('keep the last valid entry where a number is invalid', async () => {
    await press(button('Outline of T4, flat 8 mm'));
    await enterMm('Radius of point 2', '');
    expect(rack.tools[1]).toEqual(FLAT);
  });

  it('go, with their outline, but for the last one', async () => {
    await press(button('Outline of T1, ball 6 mm'));
    expect((labelled(root, 'Radius of point 1, mm') as HTMLInputElement).value).toBe('0');
    await press(button('Remove T1, ball 6 mm'));
    expect(rack.tools).toEqual([FLAT]);
    expect(() => labelled(root, 'Radius of point 1, mm')).toThrow('nothing is called');
    expect(button('Remove T4, flat 8 mm').disabled).toBe(true);
  });

  it('have no outline to edit where arcs are at odd places', () => {
    open({ ...BALL, shape: 'taper', half_angle_deg: 3 }, FLAT);
    expect(button('Outline of T1, taper 6 mm').disabled).toBe(true);
    expect(button('Outline of T4, flat 8 mm').disabled).toBe(false);
  });
});
