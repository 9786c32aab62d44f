// SPDX-License-Identifier: Apache-2.0

import { t } from '../../strings';
import { POINTS_OF } from '../../model/measure';
import type { MeasureKind } from '../../model/measure';

/** The kinds of measures: name and first hint. */
export const KINDS: readonly [MeasureKind, string, string][] = [
  ['distance', t('Distance'), t('Pick two points. They snap to corners and edges.')],
  ['thickness', t('Thickness'), t('Pick a wall to measure straight through it.')],
  ['depth', t('Depth'), t('Pick a point to measure its depth below the top of the stock.')],
  ['radius', t('Radius'), t('Pick three points on a rounded edge or a hole.')],
  ['angle', t('Angle'), t('Pick two faces to measure the angle of the material between them.')],
];

/** How to make a measure of a kind, of which so many points were pressed; empty for no kind. */
export function hintOf(kind: MeasureKind | null, pressed: number): string {
  const hint = KINDS.find(([one]) => one === kind)?.[2] ?? '';
  const of = kind && pressed > 0 ? t(' Point {0} of {1}.', pressed + 1, POINTS_OF[kind]) : '';
  return hint + of;
}
