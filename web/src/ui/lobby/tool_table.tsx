// SPDX-License-Identifier: Apache-2.0
// The tools of a program, with where each field comes from, and the box of its stock, to be edited.

import type { Signal } from '@preact/signals';
import { t } from '../../strings';
import type { FieldOrigin } from '../../model/new_block';
import type { Box } from '../../model/box';
import { toolName } from '../../model/tool_profile';
import type { ToolInfo, Vec3 } from '../../wire/types';
import { NumberInput } from '../number_input';

/** The shapes that one can change into each other here. */
const SHAPES: readonly [string, string][] = [
  ['flat', t('flat end')],
  ['ball', t('ball end')],
  ['bull_nose', t('bull nose')],
];

const ORIGINS: Record<FieldOrigin['origin'], string> = {
  stated: t('given'),
  derived: t('calculated'),
  assumed: t('assumed'),
};
const FIELDS: Record<string, string> = {
  shape: t('shape'),
  diameter_mm: t('diameter'),
  corner_radius_mm: t('corner radius'),
  tip_angle_deg: t('tip angle'),
  half_angle_deg: t('side angle'),
  profile_mm: t('outline'),
  'stock.size': t('size'),
  'stock.place': t('position'),
};

function sourceText(source: string): string {
  const line = /^(.*) in line (\d+)$/.exec(source);
  return line ? t('{0}, line {1}', line[1]!, line[2]!) : source;
}

/**
 * "diameter stated (comment, line 3); shape assumed": fields with one origin are named together.
 */
export function originText(origins: readonly FieldOrigin[]): string {
  const groups = new Map<string, string[]>();
  for (const { field, origin, source } of origins) {
    const from = source === '' || origin === 'assumed' ? '' : ` (${sourceText(source)})`;
    const key = ORIGINS[origin] + from;
    groups.set(key, [...(groups.get(key) ?? []), FIELDS[field] ?? field]);
  }
  return [...groups].map(([origin, fields]) => `${fields.join(', ')} ${origin}`).join('; ');
}

function Origins({ origins }: { origins: readonly FieldOrigin[] }) {
  const isAssumed = origins.some(({ origin }) => origin === 'assumed');
  return <span class={isAssumed ? 'origin is-assumed' : 'origin'}>{originText(origins)}</span>;
}

interface ToolProps {
  tool: ToolInfo;
  set: (tool: ToolInfo) => void;
}

/** The same tool with another shape; only a bull nose has a corner radius. */
function reshaped({ corner_radius_mm: radius, ...tool }: ToolInfo, shape: string): ToolInfo {
  return shape === 'bull_nose'
    ? { ...tool, shape, corner_radius_mm: radius ?? 0 }
    : { ...tool, shape };
}

function ShapeInputs({ tool, set }: ToolProps) {
  return (
    <>
      <select
        aria-label={t('Shape of tool {0}', tool.id)}
        class="select"
        value={tool.shape}
        onChange={({ currentTarget }) => set(reshaped(tool, currentTarget.value))}
      >
        {SHAPES.map(([value, name]) => (
          <option key={value} value={value}>
            {name}
          </option>
        ))}
      </select>
      <span>
        {'⌀ '}
        <NumberInput
          label={t('Diameter of tool {0}, mm', tool.id)}
          value={tool.diameter_mm ?? 0}
          set={(diameter_mm) => set({ ...tool, diameter_mm })}
        />
        {' mm'}
      </span>
      <span hidden={tool.shape !== 'bull_nose'}>
        {t('corner ')}
        <NumberInput
          label={t('Corner radius of tool {0}, mm', tool.id)}
          value={tool.corner_radius_mm ?? 0}
          set={(corner_radius_mm) => set({ ...tool, corner_radius_mm })}
        />
        {' mm'}
      </span>
    </>
  );
}

interface ToolTableProps {
  tools: Signal<readonly ToolInfo[]>;
  origins: readonly FieldOrigin[];
}

export function ToolTable({ tools, origins }: ToolTableProps) {
  const set = (tool: ToolInfo): void => {
    tools.value = tools.peek().map((one) => (one.id === tool.id ? tool : one));
  };
  return (
    <div>
      <span class="field-name">{t('Tools')}</span>
      <ul class="tool-table">
        {tools.value.map((tool) => (
          <li key={tool.id}>
            <b>{`T${tool.id}`}</b>
            {SHAPES.some(([shape]) => shape === tool.shape) ? (
              <ShapeInputs tool={tool} set={set} />
            ) : (
              <span>{toolName(tool)}</span>
            )}
            <Origins origins={origins.filter((origin) => origin.tool === tool.id)} />
          </li>
        ))}
      </ul>
    </div>
  );
}

interface CornerProps {
  label: string;
  at: Vec3;
  set: (at: Vec3) => void;
}

function Corner({ label, at, set }: CornerProps) {
  return (
    <div class="box-row">
      <span class="quiet">{label}</span>
      {['X', 'Y', 'Z'].map((axis, n) => (
        <span key={axis}>
          {`${axis} `}
          <NumberInput
            label={t('Stock {0} {1}, mm', label, axis)}
            value={at[n]!}
            set={(value) => set(at.map((one, place) => (place === n ? value : one)) as Vec3)}
          />
        </span>
      ))}
    </div>
  );
}

interface BoxTableProps {
  box: Signal<Box>;
  origins: readonly FieldOrigin[];
}

/** The corners of the stock. */
export function BoxTable({ box, origins }: BoxTableProps) {
  const { min, max } = box.value;
  return (
    <div>
      <span class="field-name">{t('Stock, mm')}</span>
      <Corner label={t('from')} at={min} set={(to) => (box.value = { min: to, max })} />
      <Corner label={t('to')} at={max} set={(to) => (box.value = { min, max: to })} />
      <Origins origins={origins.filter(({ field }) => field.startsWith('stock.'))} />
    </div>
  );
}
