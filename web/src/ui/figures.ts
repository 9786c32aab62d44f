// SPDX-License-Identifier: Apache-2.0
// Parts of side panels.

import { t } from '../strings';
import { h, setText } from './dom';

/** A number with its unit, under a label. */
export class Figure {
  private readonly label_ = h('dt');
  private readonly value_ = h('b');
  private readonly unit_ = h('small');
  readonly element: HTMLElement;

  constructor(label: string) {
    this.label = label;
    this.element = h('div', { class: 'figure' }, this.label_, h('dd', {}, this.value_, this.unit_));
  }

  set label(label: string) {
    setText(this.label_, label);
  }

  set(value: string, unit = ''): void {
    setText(this.value_, value);
    setText(this.unit_, unit);
  }
}

/** A part of a panel. */
export function section(title: string, ...content: HTMLElement[]): HTMLElement {
  return h('section', { 'aria-label': title }, h('h2', {}, title), ...content);
}

/** Figures for the curious, shown on request. */
export function details(...content: HTMLElement[]): HTMLElement {
  return h('details', { class: 'more' }, h('summary', {}, t('Details')), ...content);
}
