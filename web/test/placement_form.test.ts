// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { unplaced } from '../src/model/placement';
import type { Placement } from '../src/model/placement';
import { placementForm } from '../src/ui/lobby/placement_form';
import { FakeElement, stubPage } from './support/fake_dom';

const MESH = {
  file: 'a.stl',
  triangles: 1234,
  box: { min: [0, 0, 0], max: [1, 2, 3] } as const,
  repaired: '',
  isUnlikely: false,
};

describe('the form that places a model', () => {
  let placement: Placement;
  let changes: number;

  beforeEach(() => {
    stubPage();
    placement = unplaced();
    changes = 0;
  });
  afterEach(() => vi.unstubAllGlobals());

  function make(asksUnit = true, isUnlikely = false): FakeElement {
    const { min, max } = MESH.box;
    const mesh = { ...MESH, isUnlikely, box: { min: [...min], max: [...max] } } as Parameters<
      typeof placementForm
    >[0];
    return placementForm(mesh, placement, asksUnit, () => {
      changes += 1;
    }) as unknown as FakeElement;
  }
  const size = (form: FakeElement): string => form.children[0]!.textContent;
  function input(form: FakeElement, label: string): FakeElement {
    const found = form.all('number-input').find((one) => one.getAttribute('aria-label') === label);
    return found!;
  }
  function enter(form: FakeElement, label: string, value: string): void {
    const field = input(form, label);
    field.value = value;
    field.dispatch('input');
  }

  it('says how large the model is, and where', () => {
    const form = make();
    expect(size(form)).toBe('1.0 × 2.0 × 3.0 mm, from X 0.0 Y 0.0 Z 0.0');
    expect(form.children[0]!.getAttribute('role')).toBe('status');
  });

  it('asks for the unit where the file states none', () => {
    expect(make(false).all('text-input')).toEqual([]);
    const form = make(true);
    const [unit] = form.all('text-input');
    expect(unit!.options.map(({ value }) => value)).toEqual(['mm', 'cm', 'm', 'inch']);
    unit!.value = 'inch';
    unit!.dispatch('change');
    expect(placement.unit).toBe('inch');
    expect(size(form)).toMatch(/^25\.4 × 50\.8 × 76\.2 mm, /);
    expect(changes).toBe(1);
  });

  it('asks whether an unlikely size is right until the unit is chosen', () => {
    const question = (form: FakeElement): FakeElement => form.all('bad')[0]!;
    expect(question(make()).hidden).toBe(true);
    const form = make(true, true);
    expect(question(form).hidden).toBe(false);
    expect(question(form).getAttribute('role')).toBe('alert');
    const [unit] = form.all('text-input');
    unit!.value = 'm';
    unit!.dispatch('change');
    expect(question(form).hidden).toBe(true);
  });

  it('scales along all axes', () => {
    const form = make();
    enter(form, 'Scale', '2');
    expect(placement.scale).toBe(2);
    expect(size(form)).toMatch(/^2\.0 × 4\.0 × 6\.0 mm, /);
    expect(changes).toBe(1);
  });

  it('turns about each axis', () => {
    const form = make();
    enter(form, 'Rotate about X, degrees', '90');
    expect(placement.rotateDeg).toEqual([90, 0, 0]);
    expect(size(form)).toMatch(/^1\.0 × 3\.0 × 2\.0 mm, from X 0\.0 Y -3\.0 Z 0\.0$/);
    enter(form, 'Rotate about X, degrees', '0');
    enter(form, 'Rotate about Y, degrees', '90');
    enter(form, 'Rotate about Z, degrees', '-90');
    expect(placement.rotateDeg).toEqual([0, 90, -90]);
    expect(changes).toBe(4);
  });

  it('moves along each axis', () => {
    const form = make();
    ['X', 'Y', 'Z'].forEach((axis, n) => enter(form, `Move along ${axis}, mm`, `${n + 1}.5`));
    expect(placement.translateMm).toEqual([1.5, 2.5, 3.5]);
    expect(size(form)).toContain('from X 1.5 Y 2.5 Z 3.5');
    expect(changes).toBe(3);
  });

  it('says that other angles give the size at most', () => {
    const form = make();
    enter(form, 'Rotate about Z, degrees', '30');
    expect(size(form)).toMatch(/^Up to 1\.9 × 2\.2 × 3\.0 mm, /);
  });

  it('takes no text that is no number', () => {
    const form = make();
    enter(form, 'Scale', '');
    enter(form, 'Move along X, mm', 'x');
    expect(placement).toEqual(unplaced());
    expect(changes).toBe(0);
  });

  it('shows the earlier settings', () => {
    placement.scale = 3;
    placement.rotateDeg = [1, 2, 3];
    const form = make();
    expect(input(form, 'Scale').value).toBe('3');
    expect(input(form, 'Rotate about Y, degrees').value).toBe('2');
    expect(size(form)).toMatch(/^Up to /);
  });
});
