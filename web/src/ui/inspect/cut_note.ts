// SPDX-License-Identifier: Apache-2.0
// A sentence that tells who cut a place, with a button for the line of the program that did.

import { t } from '../../strings';
import { probe } from '../../link/probe';
import type { Cut, Probe } from '../../link/probe';
import type { Vec3 } from '../../wire/types';
import type { Authors } from '../authors';
import { h, setText } from '../dom';
import { sentence } from '../format';
import type { InspectHost } from './host';

export class CutNote {
  private readonly text_ = h('p', { class: 'quiet inspect-hint probe-text', role: 'status' });
  private readonly line_ = h(
    'button',
    { type: 'button', class: 'inspect-action', hidden: '' },
    t('Show line'),
  );
  readonly element = h('div', { class: 'cut-note' }, this.text_, this.line_);
  private asked_ = 0;
  private go_: () => void = () => undefined;

  constructor(
    private readonly host: InspectHost,
    private readonly session: string,
    private readonly authors: Authors,
  ) {
    this.line_.addEventListener('click', () => this.go_());
  }

  /** Shows a text, and drops the answer to the last request. */
  say(text: string): void {
    this.asked_ += 1;
    this.write_(text);
  }

  /** Asks about a place of the displayed surface. Null: another one was asked about, or it failed. */
  async ask(point: Vec3, normal: Vec3): Promise<Probe | null> {
    this.say(t('Loading…'));
    const asked = this.asked_;
    try {
      const at = this.host.model.state?.at?.record ?? null;
      const found = await probe(this.session, point, normal, at);
      const { cut } = found;
      if (cut && !this.authors.knows(cut.participant)) await this.authors.load();
      if (asked !== this.asked_) return null;
      this.show_(cut, found.atMm ?? point);
      return found;
    } catch (problem) {
      if (asked === this.asked_) this.write_(sentence((problem as Error).message));
      return null;
    }
  }

  private write_(text: string): void {
    setText(this.text_, text);
    this.line_.hidden = true;
  }

  private show_(cut: Cut | null, place: Vec3): void {
    this.write_(cut ? this.textOf_(cut) : t('Original stock surface, not cut yet.'));
    const program = cut?.program;
    if (!program || program.line === 0) return;
    this.line_.hidden = false;
    this.go_ = () => this.host.showLine?.({ program: program.id, line: program.line, place });
  }

  private textOf_({ participant, tool, program }: Cut): string {
    const name = program?.name ?? this.authors.nameOf(participant);
    return program && program.line > 0
      ? t('Cut by {0} in line {1}, with tool {2}.', name, program.line, tool)
      : t('Cut by {0} with tool {1}.', name, tool);
  }
}
