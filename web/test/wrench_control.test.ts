// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { signal } from '@preact/signals';
import type { Signal } from '@preact/signals';
import { h } from 'preact';
import { beforeEach, describe, expect, it } from 'vitest';
import type { LineSegments } from 'three';
import type { WrenchPeak } from '../src/model/wrench_path';
import type { Picture } from '../src/ui/picture';
import { WrenchControl } from '../src/ui/programs/wrench_control';
import { WrenchRow } from '../src/ui/programs/wrench_row';
import { show } from './support/shown';
import { turn } from './support/turn';

const PEAKS: WrenchPeak[] = [
  { tipMm: [0, 0, 0], forceN: [-3, 0, 0], torqueNmm: [0, 20, 0] },
  { tipMm: [9, 0, 0], forceN: [-1, 0, 0], torqueNmm: [0, 5, 0] },
];

describe('force and torque along the path of a program', () => {
  let lines: LineSegments[];
  let isOpen: Signal<boolean>;
  let peaks: Signal<readonly WrenchPeak[]>;
  let row: HTMLElement;
  const arrows = (): number[] =>
    lines.map(({ geometry }) => geometry.getAttribute('position').count / 6);

  async function choose(isChosen: boolean): Promise<void> {
    const box = row.querySelector('input')!;
    box.checked = isChosen;
    box.dispatchEvent(new Event('change'));
    await turn();
  }
  async function become(now: readonly WrenchPeak[]): Promise<void> {
    peaks.value = now;
    await turn();
  }

  beforeEach(() => {
    lines = [];
    isOpen = signal(false);
    peaks = signal([]);
    const scene = { add: (...all: LineSegments[]) => lines.push(...all) };
    const picture = { viewer: { stage: { scene }, touch: () => undefined } };
    const wrench = new WrenchControl(picture as unknown as Picture, isOpen, peaks, () => 12);
    row = show(h(WrenchRow, { wrench }));
  });

  it('are drawn when they are asked for and the panel is open', async () => {
    isOpen.value = true;
    await become(PEAKS);
    expect(lines).toEqual([]);
    await choose(true);
    expect(arrows()).toEqual([2, 2]);
    isOpen.value = false;
    expect(arrows()).toEqual([0, 0]);
    isOpen.value = true;
    expect(arrows()).toEqual([2, 2]);
    await choose(false);
    expect(arrows()).toEqual([0, 0]);
  });

  it('follow the program', async () => {
    isOpen.value = true;
    await become(PEAKS);
    await choose(true);
    await become(PEAKS.slice(1));
    expect(arrows()).toEqual([1, 1]);
    await become([]);
    expect(arrows()).toEqual([0, 0]);
    await become(PEAKS); // still asked for
    expect(arrows()).toEqual([2, 2]);
    expect(row.querySelector('input')!.checked).toBe(true);
  });

  it('have a legend with the greatest values, and no row where nothing was cut', async () => {
    expect(row.childElementCount).toBe(0);
    await become(PEAKS);
    expect(row.textContent).toContain('Show force and torque');
    expect(row.textContent).toContain('up to 3 N');
    expect(row.textContent).toContain('up to 20 N·mm');
    await become([]);
    expect(row.childElementCount).toBe(0);
  });
});
