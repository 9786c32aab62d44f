// SPDX-License-Identifier: Apache-2.0
// The list of programs as buttons. Rows stay as they are while their texts change, so that a row can
// be clicked and keeps the focus while the server pushes.

import { t } from '../../strings';
import type { ProgramInfo } from '../../wire/types';
import { h, setText } from '../dom';
import { count } from '../format';
import { stateText } from './texts';

interface Row {
  element: HTMLElement;
  button: HTMLElement;
  name: HTMLElement;
  state: HTMLElement;
}

export class ProgramList {
  readonly element = h('ul', { class: 'program-list', 'aria-label': t('Programs') });
  private readonly rows_ = new Map<number, Row>();

  constructor(private readonly pressed: (id: number) => void) {}

  /** Shows the programs in this order; `selected` is the pressed one. */
  update(programs: readonly ProgramInfo[], selected: number | null): void {
    const listed = new Set(programs.map((program) => program.id));
    for (const [id, row] of this.rows_) {
      if (listed.has(id)) continue;
      row.element.remove();
      this.rows_.delete(id);
    }
    programs.forEach((program, at) => {
      const row = this.rows_.get(program.id) ?? this.add_(program.id);
      const there = this.element.children[at] ?? null;
      if (there !== row.element) this.element.insertBefore(row.element, there);
      this.updateRow_(row, program, selected);
    });
  }

  private add_(id: number): Row {
    const name = h('b');
    const state = h('small');
    const button = h('button', { type: 'button', class: 'program-row-button' }, name, state);
    button.addEventListener('click', () => this.pressed(id));
    const row = { element: h('li', {}, button), button, name, state };
    this.rows_.set(id, row);
    return row;
  }

  private updateRow_(row: Row, program: ProgramInfo, selected: number | null): void {
    const noun = program.alarm_count === 1 ? t('alarm') : t('alarms');
    const alarms = program.alarm_count > 0 ? ` · ${count(program.alarm_count)} ${noun}` : '';
    setText(row.name, program.name);
    setText(row.state, `${stateText(program)}${alarms}`);
    row.button.setAttribute('data-state', program.state);
    row.button.setAttribute('aria-pressed', String(program.id === selected));
  }
}
