// SPDX-License-Identifier: Apache-2.0
// The participant whose forces are plotted and whose strokes are undone, and the one whose tool the
// camera follows.

import { effect, signal } from '@preact/signals';
import type { Participants } from '../model/participants';
import type { Picture } from './picture';

export class PersonChoice {
  private readonly selected_ = signal<number | null>(null);

  constructor(
    private readonly participants: Participants,
    private readonly picture: Pick<Picture, 'followed' | 'follow'>,
  ) {
    effect(() => this.leaveAbsent_());
  }

  /** Null while nobody carves. */
  get selected(): number | null {
    return this.selected_.value;
  }

  get followed(): number | null {
    return this.picture.followed;
  }

  /** Selects a participant; follows its tool, or ends that. */
  press(id: number): void {
    this.selected_.value = id;
    this.picture.follow(this.followed === id ? null : id);
  }

  /** Follows the next tool; none after the last one. */
  followNext(): void {
    const ids = this.participants.carvers().map(({ info }) => info.participant);
    const next = ids[ids.indexOf(this.followed ?? -1) + 1] ?? null;
    if (next !== null) this.selected_.value = next;
    this.picture.follow(next);
  }

  private leaveAbsent_(): void {
    const { participants, selected, followed } = this;
    if (selected === null || !participants.get(selected))
      this.selected_.value = participants.carvers()[0]?.info.participant ?? null;
    if (followed !== null && !participants.get(followed)) this.picture.follow(null);
  }
}
