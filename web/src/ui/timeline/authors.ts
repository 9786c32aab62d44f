// SPDX-License-Identifier: Apache-2.0
// Names and colors of those who have carved, also of those who have left.

import { t } from '../../strings';
import type { SessionModel } from '../../model/session';
import { colorOfUnknown } from '../../model/participants';

export class Authors {
  private readonly known_ = new Map<number, { name: string; color: string }>();

  constructor(private readonly model: SessionModel) {}

  /** Keeps who is there now. */
  note(): void {
    for (const { info } of this.model.participants.carvers())
      this.known_.set(info.participant, { name: info.name, color: info.color });
  }

  nameOf(participant: number): string {
    return this.known_.get(participant)?.name ?? t('Participant {0}', participant);
  }

  colorOf(participant: number): string {
    return this.known_.get(participant)?.color ?? colorOfUnknown(participant);
  }
}
