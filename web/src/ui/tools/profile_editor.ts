// SPDX-License-Identifier: Apache-2.0
// Edits the outline of a tool: by handles in its drawing and by numbers, which follow each other.

import { t } from '../../strings';
import {
  pointsOf,
  withoutPoint,
  withPoint,
  withPointBefore,
  withPoints,
} from '../../model/profile_draft';
import type { Edge, ProfilePoint } from '../../model/profile_draft';
import type { ToolInfo } from '../../wire/types';
import { h } from '../dom';
import { numberInput } from '../number_input';
import { ProfileDrawing } from './profile_drawing';

const EDGES: readonly [Edge, string][] = [
  ['line', t('line')],
  ['out', t('arc outward')],
  ['in', t('arc inward')],
];
const POINTS_LEAST = 2;

interface Row {
  element: HTMLElement;
  r: HTMLInputElement;
  z: HTMLInputElement;
  radius: HTMLInputElement;
}

export class ProfileEditor {
  readonly element: HTMLElement;
  private readonly drawing_ = new ProfileDrawing((n, r, z) => this.change_(n, { r, z }));
  private readonly list_ = h('ol', {
    class: 'profile-points',
    'aria-label': t('Points from the tip up'),
  });
  private rows_: Row[] = [];
  private points_: ProfilePoint[];

  /** @param changed is given the tool with its new outline */
  constructor(
    private tool: ToolInfo,
    private readonly changed: (tool: ToolInfo) => void,
  ) {
    this.points_ = pointsOf(tool) ?? [];
    this.element = h('div', { class: 'profile-editor' }, this.drawing_.element, this.list_);
    this.build_();
  }

  private change_(n: number, change: Partial<ProfilePoint>): void {
    this.set_(withPoint(this.points_, n, change));
    this.showNumbers_(n);
  }

  /** Other points: other rows. */
  private restructure_(points: ProfilePoint[]): void {
    this.set_(points);
    this.build_();
  }

  private set_(points: ProfilePoint[]): void {
    this.points_ = points;
    this.tool = withPoints(this.tool, points);
    this.drawing_.show(this.tool, points);
    this.changed(this.tool);
  }

  private build_(): void {
    this.rows_ = this.points_.map((point, n) => this.row_(point, n));
    this.list_.replaceChildren(...this.rows_.map(({ element }) => element));
    this.drawing_.show(this.tool, this.points_);
  }

  /** The numbers of a point and the radius of the arc behind it; not those that are being typed. */
  private showNumbers_(n: number): void {
    const show = (input: HTMLInputElement, value: number): void => {
      if (input !== document.activeElement && input.valueAsNumber !== value)
        input.value = String(value);
    };
    for (const at of [n, n + 1]) {
      const [row, point] = [this.rows_[at], this.points_[at]];
      if (!row || !point) continue;
      show(row.r, point.r);
      show(row.z, point.z);
      show(row.radius, point.radius);
    }
  }

  private row_(point: ProfilePoint, n: number): Row {
    const name = n + 1;
    const r = numberInput(t('Radius of point {0}, mm', name), point.r, (value) =>
      this.change_(n, { r: value }),
    );
    const z = numberInput(t('Height of point {0}, mm', name), point.z, (value) =>
      this.change_(n, { z: value }),
    );
    const radius = numberInput(
      t('Radius of the arc to point {0}, mm', name),
      point.radius,
      (value) => this.change_(n, { radius: value }),
    );
    radius.hidden = point.edge === 'line';
    const edge = h(
      'select',
      { class: 'select', 'aria-label': t('Line or arc to point {0}', name) },
      ...EDGES.map(([value, text]) => h('option', { value }, text)),
    );
    edge.value = point.edge;
    edge.hidden = n === 0;
    edge.addEventListener('change', () => {
      radius.hidden = edge.value === 'line';
      this.change_(n, { edge: edge.value as Edge });
    });
    const element = h('li', {}, h('span', {}, '⌀/2 ', r), h('span', {}, '↑ ', z), edge, radius);
    if (n > 0)
      element.append(
        this.button_('+', t('Add a point before point {0}', name), () =>
          this.restructure_(withPointBefore(this.points_, n)),
        ),
      );
    if (n > 0 && this.points_.length > POINTS_LEAST)
      element.append(
        this.button_('−', t('Remove point {0}', name), () =>
          this.restructure_(withoutPoint(this.points_, n)),
        ),
      );
    return { element, r, z, radius };
  }

  private button_(text: string, label: string, action: () => void): HTMLElement {
    const button = h(
      'button',
      { type: 'button', class: 'button quiet-button', 'aria-label': label, title: label },
      text,
    );
    button.addEventListener('click', action);
    return button;
  }
}
