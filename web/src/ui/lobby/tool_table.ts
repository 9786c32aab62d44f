// SPDX-License-Identifier: Apache-2.0
// The tools of a program, with where each field comes from, and the box of its stock, to be edited.

import { t } from '../../strings';
import type { FieldOrigin } from '../../model/new_block';
import type { Box } from '../../model/box';
import { toolName } from '../../model/tool_profile';
import type { ToolInfo, Vec3 } from '../../wire/types';
import { h } from '../dom';
import { numberInput } from '../number_input';

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

function originLine(origins: readonly FieldOrigin[]): HTMLElement {
  const assumed = origins.some(({ origin }) => origin === 'assumed');
  return h('span', { class: assumed ? 'origin is-assumed' : 'origin' }, originText(origins));
}

function shapeInputs(tool: ToolInfo, changed: () => void): HTMLElement[] {
  const shape = h(
    'select',
    { 'aria-label': t('Shape of tool {0}', tool.id), class: 'select' },
    ...SHAPES.map(([value, name]) => h('option', { value }, name)),
  );
  const diameter = numberInput(
    t('Diameter of tool {0}, mm', tool.id),
    tool.diameter_mm ?? 0,
    (value) => {
      tool.diameter_mm = value;
      changed();
    },
  );
  const radius = numberInput(
    t('Corner radius of tool {0}, mm', tool.id),
    tool.corner_radius_mm ?? 0,
    (value) => {
      tool.corner_radius_mm = value;
      changed();
    },
  );
  const corner = h('span', {}, t('corner '), radius, ' mm');
  const show = (): void => {
    corner.hidden = tool.shape !== 'bull_nose';
  };
  shape.value = tool.shape;
  show();
  shape.addEventListener('change', () => {
    tool.shape = shape.value;
    if (tool.shape === 'bull_nose') tool.corner_radius_mm = radius.valueAsNumber || 0;
    else delete tool.corner_radius_mm;
    show();
    changed();
  });
  return [shape, h('span', {}, '⌀ ', diameter, ' mm'), corner];
}

function toolRow(
  tool: ToolInfo,
  origins: readonly FieldOrigin[],
  changed: () => void,
): HTMLElement {
  const isPlain = SHAPES.some(([shape]) => shape === tool.shape);
  return h(
    'li',
    {},
    h('b', {}, `T${tool.id}`),
    ...(isPlain ? shapeInputs(tool, changed) : [h('span', {}, toolName(tool))]),
    originLine(origins.filter((origin) => origin.tool === tool.id)),
  );
}

/** Inputs that write to `tools` as they are edited. */
export function toolTable(
  tools: readonly ToolInfo[],
  origins: readonly FieldOrigin[],
  changed: () => void,
): HTMLElement {
  const rows = tools.map((tool) => toolRow(tool, origins, changed));
  return h(
    'div',
    {},
    h('span', { class: 'field-name' }, t('Tools')),
    h('ul', { class: 'tool-table' }, ...rows),
  );
}

/** Inputs for the corners of a box, which they write to. */
export function boxTable(
  box: Box,
  origins: readonly FieldOrigin[],
  changed: () => void,
): HTMLElement {
  const corner = (label: string, at: Vec3): HTMLElement =>
    h(
      'div',
      { class: 'box-row' },
      h('span', { class: 'quiet' }, label),
      ...['X', 'Y', 'Z'].map((axis, n) =>
        h(
          'span',
          {},
          `${axis} `,
          numberInput(t('Stock {0} {1}, mm', label, axis), at[n]!, (value) => {
            at[n] = value;
            changed();
          }),
        ),
      ),
    );
  return h(
    'div',
    {},
    h('span', { class: 'field-name' }, t('Stock, mm')),
    corner(t('from'), box.min),
    corner(t('to'), box.max),
    originLine(origins.filter(({ field }) => field.startsWith('stock.'))),
  );
}
