// SPDX-License-Identifier: Apache-2.0
// A sentence that tells who cut a place, with a button for the line of the program that did.

import { batch, signal } from '@preact/signals';
import { t } from '../../strings';
import { probe } from '../../link/probe';
import type { Cut, Probe } from '../../link/probe';
import type { ProgramPlace } from '../../model/program_place';
import type { Vec3 } from '../../wire/types';
import type { Authors } from '../authors';
import { sentence } from '../format';
import type { InspectHost } from './host';

export class CutNote {
  readonly text = signal('');
  /** The line that the button shows; null: no button. */
  readonly line = signal<ProgramPlace | null>(null);
  private asked_ = 0;

  constructor(
    private readonly host: InspectHost,
    private readonly session: string,
    private readonly authors: Authors,
  ) {}

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

  showLine(): void {
    const place = this.line.peek();
    if (place) this.host.showLine?.(place);
  }

  private write_(text: string, line: ProgramPlace | null = null): void {
    batch(() => {
      this.text.value = text;
      this.line.value = line;
    });
  }

  private show_(cut: Cut | null, place: Vec3): void {
    const program = cut?.program;
    const hasLine = program && program.line > 0;
    this.write_(
      cut ? this.textOf_(cut) : t('Original stock surface, not cut yet.'),
      hasLine ? { program: program.id, line: program.line, place } : null,
    );
  }

  private textOf_({ participant, tool, program }: Cut): string {
    const name = program?.name ?? this.authors.nameOf(participant);
    return program && program.line > 0
      ? t('Cut by {0} in line {1}, with tool {2}.', name, program.line, tool)
      : t('Cut by {0} with tool {1}.', name, tool);
  }
}

export function CutNoteView({ note }: { note: CutNote }) {
  return (
    <div class="cut-note">
      <p class="quiet inspect-hint probe-text" role="status">
        {note.text.value}
      </p>
      <button
        type="button"
        class="inspect-action"
        hidden={note.line.value === null}
        onClick={() => note.showLine()}
      >
        {t('Show line')}
      </button>
    </div>
  );
}
