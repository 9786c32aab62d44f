// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { beforeEach, describe, expect, it } from 'vitest';
import type { LineSegments } from 'three';
import type { WrenchPeak } from '../src/model/wrench_path';
import type { Picture } from '../src/ui/picture';
import { WrenchControl } from '../src/ui/programs/wrench_control';

const PEAKS: WrenchPeak[] = [
  { tipMm: [0, 0, 0], forceN: [-3, 0, 0], torqueNmm: [0, 20, 0] },
  { tipMm: [9, 0, 0], forceN: [-1, 0, 0], torqueNmm: [0, 5, 0] },
];

describe('force and torque along the path of a program', () => {
  let lines: LineSegments[];
  let control: WrenchControl;
  const arrows = (): number[] =>
    lines.map(({ geometry }) => geometry.getAttribute('position').count / 6);
  function choose(isChosen: boolean): void {
    const box = control.element.querySelector('input')!;
    box.checked = isChosen;
    box.dispatchEvent(new Event('change'));
  }

  beforeEach(() => {
    lines = [];
    const scene = { add: (...all: LineSegments[]) => lines.push(...all) };
    const picture = { viewer: { stage: { scene }, touch: () => undefined } };
    control = new WrenchControl(picture as unknown as Picture, () => 12);
  });

  it('are drawn when they are asked for and the panel is open', () => {
    control.setOpen(true);
    control.show(PEAKS);
    expect(lines).toEqual([]);
    choose(true);
    expect(arrows()).toEqual([2, 2]);
    control.setOpen(false);
    expect(arrows()).toEqual([0, 0]);
    control.setOpen(true);
    expect(arrows()).toEqual([2, 2]);
    choose(false);
    expect(arrows()).toEqual([0, 0]);
  });

  it('have a legend with the greatest values, and no row where nothing was cut', () => {
    expect(control.element.hidden).toBe(true);
    control.show(PEAKS);
    expect(control.element.hidden).toBe(false);
    expect(control.element.textContent).toContain('up to 3 N');
    expect(control.element.textContent).toContain('up to 20 N·mm');
    control.show([]);
    expect(control.element.hidden).toBe(true);
  });
});
