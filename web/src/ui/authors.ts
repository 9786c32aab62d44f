// SPDX-License-Identifier: Apache-2.0
// Names and colors of those who have carved, also of those who have left.

import { t } from '../strings';
import { listAuthors } from '../link/owners';
import { colorOfUnknown } from '../model/participants';
import type { SessionModel } from '../model/session';

export class Authors {
  /** @param session null: without a server */
  constructor(
    private readonly model: SessionModel,
    private readonly session: string | null,
  ) {}

  /** Asks for all of them. Those whom the server does not tell have numbers. */
  async load(): Promise<void> {
    if (this.session === null) return;
    try {
      this.model.participants.learn(await listAuthors(this.session));
    } catch (problem) {
      console.warn('The names of those who have left are not known:', problem);
    }
  }

  knows(participant: number): boolean {
    return this.model.participants.author(participant) !== undefined;
  }

  nameOf(participant: number): string {
    const author = this.model.participants.author(participant);
    return author?.name ?? t('Participant {0}', participant);
  }

  colorOf(participant: number): string {
    return this.model.participants.author(participant)?.color ?? colorOfUnknown(participant);
  }
}
