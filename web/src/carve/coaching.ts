// SPDX-License-Identifier: Apache-2.0
// One line of coaching: until the first stroke how to carve, until the first lean how to reach the
// sides, and then nothing any more, in no later session either.

import { t } from '../strings';
import { recall, remember } from '../strings/memory';

const KEY = 'coached';

type Learned = 'stroke' | 'lean';

export class Coaching {
  private learned_ = recall(KEY);

  constructor(private readonly isTouched: () => boolean) {}

  /** The line; empty: there is nothing more to say. */
  get text(): string {
    if (this.learned_ === 'lean') return '';
    if (this.learned_ === 'stroke')
      return this.isTouched()
        ? t('Two fingers turn the block. Its sides can be carved too.')
        : t('Right-drag turns the block. Its sides can be carved too.');
    return this.isTouched()
      ? t('Draw on the block with one finger to carve.')
      : t('Drag on the block to carve.');
  }

  /** The user has carved a stroke. */
  stroked(): void {
    if (this.learned_ === null) this.learn_('stroke');
  }

  /** The tool has leaned in a cut: a side was carved. */
  leaned(): void {
    if (this.learned_ !== 'lean') this.learn_('lean');
  }

  private learn_(what: Learned): void {
    this.learned_ = what;
    remember(KEY, what);
  }
}
