// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { signal } from '@preact/signals';
import type { Signal } from '@preact/signals';
import { h } from 'preact';
import { beforeEach, describe, expect, it } from 'vitest';
import { unplaced } from '../src/model/placement';
import type { Placement } from '../src/model/placement';
import { PlacementForm } from '../src/ui/lobby/placement_form';
import type { PlacementFormProps } from '../src/ui/lobby/placement_form';
import { enter, labelled, show } from './support/shown';

const MESH = {
  file: 'a.stl',
  triangles: 1234,
  box: { min: [0, 0, 0], max: [1, 2, 3] } as const,
  repaired: '',
  isUnlikely: false,
};

describe('the form that places a model', () => {
  let placement: Signal<Placement>;
  let root: HTMLElement;

  beforeEach(() => {
    placement = signal(unplaced());
  });

  function open(asksUnit = true, isUnlikely = false): void {
    const { min, max } = MESH.box;
    const mesh = { ...MESH, isUnlikely, box: { min: [...min], max: [...max] } };
    root = show(h(PlacementForm, { mesh, placement, asksUnit } as PlacementFormProps));
  }
  const size = (): string => root.querySelector('[role=status]')!.textContent;
  const unit = (): HTMLSelectElement => root.querySelector('select')!;
  const question = (): HTMLElement => root.querySelector('[role=alert]')!;
  const field = (label: string): HTMLInputElement => labelled(root, label) as HTMLInputElement;
  const fill = (label: string, value: string): Promise<void> => enter(field(label), value);

  it('says how large the model is, and where', () => {
    open();
    expect(size()).toBe('1.0 × 2.0 × 3.0 mm, from X 0.0 Y 0.0 Z 0.0');
  });

  it('asks for the unit where the file states none', async () => {
    open(false);
    expect(root.querySelector('select')).toBeNull();
    open(true);
    expect([...unit().options].map(({ value }) => value)).toEqual(['mm', 'cm', 'm', 'inch']);
    await enter(unit(), 'inch');
    expect(placement.value.unit).toBe('inch');
    expect(size()).toMatch(/^25\.4 × 50\.8 × 76\.2 mm, /);
  });

  it('asks whether an unlikely size is right until the unit is chosen', async () => {
    open();
    expect(question().hidden).toBe(true);
    open(true, true);
    expect(question().hidden).toBe(false);
    await enter(unit(), 'm');
    expect(question().hidden).toBe(true);
  });

  it('scales along all axes', async () => {
    open();
    await fill('Scale', '2');
    expect(placement.value.scale).toBe(2);
    expect(size()).toMatch(/^2\.0 × 4\.0 × 6\.0 mm, /);
  });

  it('turns about each axis', async () => {
    open();
    await fill('Rotate about X, degrees', '90');
    expect(placement.value.rotateDeg).toEqual([90, 0, 0]);
    expect(size()).toMatch(/^1\.0 × 3\.0 × 2\.0 mm, from X 0\.0 Y -3\.0 Z 0\.0$/);
    await fill('Rotate about X, degrees', '0');
    await fill('Rotate about Y, degrees', '90');
    await fill('Rotate about Z, degrees', '-90');
    expect(placement.value.rotateDeg).toEqual([0, 90, -90]);
  });

  it('moves along each axis', async () => {
    open();
    for (const [n, axis] of ['X', 'Y', 'Z'].entries())
      await fill(`Move along ${axis}, mm`, `${n + 1}.5`);
    expect(placement.value.translateMm).toEqual([1.5, 2.5, 3.5]);
    expect(size()).toContain('from X 1.5 Y 2.5 Z 3.5');
  });

  it('says that other angles give the size at most', async () => {
    open();
    await fill('Rotate about Z, degrees', '30');
    expect(size()).toMatch(/^Up to 1\.9 × 2\.2 × 3\.0 mm, /);
  });

  it('takes no text that is no number', async () => {
    open();
    await fill('Scale', '');
    await fill('Move along X, mm', 'x');
    expect(placement.value).toEqual(unplaced());
  });

  it('shows the earlier settings', () => {
    placement.value = { ...unplaced(), scale: 3, rotateDeg: [1, 2, 3] };
    open();
    expect(field('Scale').value).toBe('3');
    expect(field('Rotate about Y, degrees').value).toBe('2');
    expect(size()).toMatch(/^Up to /);
  });
});
