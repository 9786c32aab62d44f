// SPDX-License-Identifier: Apache-2.0
// The accuracy of a new block, and its price, which the server states while the slider moves.

import { t } from '../../strings';
import { priceOf } from '../../link/lobby_requests';
import type { NamedProgram } from '../../link/lobby_requests';
import { motionPriceText, priceText, TARGET_DEFAULT_MM, TARGETS_MM } from '../../model/new_block';
import type { Scene } from '../../model/new_block';
import { h, setText } from '../dom';
import { sentence } from '../format';

export interface AccuracyActions {
  changed: () => void;
  /** Whether the last scene can be made. */
  priced: (possible: boolean) => void;
}

export class Accuracy {
  private readonly slider_ = h('input', {
    type: 'range',
    min: '0',
    max: String(TARGETS_MM.length - 1),
    step: '1',
    class: 'accuracy-slider',
    'aria-label': t('Accuracy'),
  });
  private readonly price_ = h('p', { class: 'price', role: 'status' });
  private readonly motion_ = h('p');
  private readonly details_ = h(
    'details',
    { class: 'quiet', hidden: '' },
    h('summary', {}, t('Details')),
    this.motion_,
  );
  readonly element = h(
    'div',
    { class: 'accuracy' },
    h('span', { class: 'field-name' }, t('Accuracy')),
    h(
      'div',
      { class: 'accuracy-ends' },
      h('small', {}, t('coarse, fast')),
      this.slider_,
      h('small', {}, t('fine, slow')),
    ),
    this.price_,
    this.details_,
  );
  private asking_: AbortController | null = null;

  constructor(private readonly actions: AccuracyActions) {
    this.targetMm = TARGET_DEFAULT_MM;
    this.slider_.addEventListener('input', () => {
      this.describe_();
      actions.changed();
    });
  }

  get targetMm(): number {
    return TARGETS_MM[Number(this.slider_.value)]!;
  }

  set targetMm(target: number) {
    this.slider_.value = String(Math.max(0, TARGETS_MM.indexOf(target)));
    this.describe_();
  }

  /**
   * Shows the price of a scene, or of a program in it. A later call replaces an earlier one that has
   * no answer yet.
   */
  async show(scene: Scene, program: NamedProgram | null): Promise<void> {
    this.asking_?.abort();
    const asking = new AbortController();
    this.asking_ = asking;
    const { targetMm } = this;
    try {
      const price = await priceOf(scene, program, asking.signal);
      if (this.asking_ !== asking) return;
      this.tell_(priceText(price, targetMm), true);
      setText(this.motion_, motionPriceText(price));
    } catch (problem) {
      if (this.asking_ === asking) this.tell_(sentence((problem as Error).message), false);
    }
  }

  private tell_(text: string, possible: boolean): void {
    setText(this.price_, text);
    this.price_.classList.toggle('bad', !possible);
    this.details_.hidden = !possible;
    this.actions.priced(possible);
  }

  private describe_(): void {
    this.slider_.setAttribute('aria-valuetext', `${this.targetMm} mm`);
  }
}
