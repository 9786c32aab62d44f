// SPDX-License-Identifier: Apache-2.0
// The state of the panel of programs.

import { signal } from '@preact/signals';
import type { Signal } from '@preact/signals';
import type { SessionModel } from '../../model/session';
import type { ProgramInfo } from '../../wire/types';
import type { ProgramDetails } from './requests';

export class ProgramsState {
  readonly selected = signal<number | null>(null);
  /** A rejected file is shown. No program replaces it unless the user selects one. */
  readonly showsRejected = signal(false);
  /** The program whose text is shown; null while no text or that of a rejected file is. */
  readonly textOf = signal<number | null>(null);
  readonly note = signal({ text: '', isBad: false });
  private readonly details_ = signal<ReadonlyMap<number, ProgramDetails>>(new Map());

  /** @param isOpen whether the panel is open */
  constructor(
    private readonly model: SessionModel,
    readonly isOpen: Signal<boolean>,
  ) {}

  /** The selected program. */
  get program(): ProgramInfo | undefined {
    const id = this.selected.value;
    return id === null ? undefined : this.model.programs.get(id);
  }

  get programs(): readonly ProgramInfo[] {
    return this.model.programs.all();
  }

  /** The details of the selected program, once they have been requested. */
  get details(): ProgramDetails | undefined {
    const id = this.selected.value;
    return id === null ? undefined : this.details_.value.get(id);
  }

  may(what: 'run_programs' | 'download'): boolean {
    return this.model.welcome?.may?.includes(what) ?? true;
  }

  /** Keeps the programs of an answer. */
  keep(answer: readonly ProgramDetails[]): void {
    const details = new Map(this.details_.peek());
    for (const one of answer) details.set(one.program.id, one);
    this.details_.value = details;
    this.model.programs.add(answer.map(({ program }) => program));
  }
}
