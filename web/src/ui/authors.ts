// SPDX-License-Identifier: Apache-2.0
// Names and colors of those who have carved, also of those who have left.

import { t } from '../strings';
import { listAuthors } from '../link/owners';
import { colorOfUnknown } from '../model/participants';
import type { SessionModel } from '../model/session';

export class Authors {
  private readonly known_ = new Map<number, { name: string; color: string }>();

  /** @param session null: without a server */
  constructor(
    private readonly model: SessionModel,
    private readonly session: string | null,
  ) {}

  /** Keeps who is there now. */
  note(): void {
    for (const { info } of this.model.participants.carvers())
      this.known_.set(info.participant, { name: info.name, color: info.color });
  }

  /** Asks for all of them. Those whom the server does not tell have numbers. */
  async load(): Promise<void> {
    if (this.session === null) return;
    try {
      for (const { participant, name, color } of await listAuthors(this.session))
        this.known_.set(participant, { name, color });
    } catch (problem) {
      console.warn('The names of those who have left are not known:', problem);
    }
    this.note();
  }

  knows(participant: number): boolean {
    return this.known_.has(participant);
  }

  nameOf(participant: number): string {
    return this.known_.get(participant)?.name ?? t('Participant {0}', participant);
  }

  colorOf(participant: number): string {
    return this.known_.get(participant)?.color ?? colorOfUnknown(participant);
  }
}
