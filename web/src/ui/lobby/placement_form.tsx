// SPDX-License-Identifier: Apache-2.0
// Unit, scale, turns and place of a model, to be edited, and the size that it has so.

import type { Signal } from '@preact/signals';
import { t } from '../../strings';
import type { UploadedMesh } from '../../link/lobby_requests';
import { isRight, placedBox, UNITS_MM } from '../../model/placement';
import type { Placement } from '../../model/placement';
import type { Vec3 } from '../../wire/types';
import { NumberInput } from '../number_input';

function sizeText({ box }: UploadedMesh, placement: Placement): string {
  const { min, max } = placedBox(box, placement);
  const side = (n: number): string => (max[n]! - min[n]!).toFixed(1);
  const place = (n: number): string => min[n]!.toFixed(1);
  const size = t(
    '{0} × {1} × {2} mm, from X {3} Y {4} Z {5}',
    side(0),
    side(1),
    side(2),
    place(0),
    place(1),
    place(2),
  );
  return isRight(placement) ? size : t('Up to {0}', size);
}

const AXES = ['X', 'Y', 'Z'] as const;

interface AxesRowProps {
  name: string;
  label: (axis: string) => string;
  values: Vec3;
  set: (values: Vec3) => void;
}

function AxesRow({ name, label, values, set }: AxesRowProps) {
  return (
    <div class="box-row">
      <span class="quiet wide">{name}</span>
      {AXES.map((axis, n) => (
        <span key={axis}>
          {`${axis} `}
          <NumberInput
            label={label(axis)}
            value={values[n]!}
            set={(value) => set(values.map((one, at) => (at === n ? value : one)) as Vec3)}
          />
        </span>
      ))}
    </div>
  );
}

interface UnitFieldProps {
  unit: string;
  choose: (unit: string) => void;
}

function UnitField({ unit, choose }: UnitFieldProps) {
  return (
    <label class="field">
      <span class="field-name">{t('Unit of the model')}</span>
      <select
        class="text-input"
        value={unit}
        onChange={({ currentTarget }) => choose(currentTarget.value)}
      >
        {Object.keys(UNITS_MM).map((one) => (
          <option key={one} value={one}>
            {one}
          </option>
        ))}
      </select>
    </label>
  );
}

export interface PlacementFormProps {
  mesh: UploadedMesh;
  placement: Signal<Placement>;
  /** The file states no unit. */
  asksUnit: boolean;
}

export function PlacementForm({ mesh, placement, asksUnit }: PlacementFormProps) {
  const { value: placed } = placement;
  const set = (change: Partial<Placement>): void => {
    placement.value = { ...placement.peek(), ...change };
  };
  const isAsked = mesh.isUnlikely && placed.unit === 'mm' && placed.scale === 1;
  return (
    <div class="draft-mesh">
      <p role="status">{sizeText(mesh, placed)}</p>
      {asksUnit && (
        <>
          <p role="alert" class="bad" hidden={!isAsked}>
            {t('Is this the right size? Choose the unit.')}
          </p>
          <UnitField unit={placed.unit} choose={(unit) => set({ unit })} />
        </>
      )}
      <details>
        <summary>{t('Rotate, scale, move')}</summary>
        <AxesRow
          name={t('Rotate, degrees')}
          label={(axis) => t('Rotate about {0}, degrees', axis)}
          values={placed.rotateDeg}
          set={(rotateDeg) => set({ rotateDeg })}
        />
        <div class="box-row">
          <span class="quiet wide">{t('Scale')}</span>
          <NumberInput label={t('Scale')} value={placed.scale} set={(scale) => set({ scale })} />
        </div>
        <AxesRow
          name={t('Move, mm')}
          label={(axis) => t('Move along {0}, mm', axis)}
          values={placed.translateMm}
          set={(translateMm) => set({ translateMm })}
        />
      </details>
    </div>
  );
}
