// SPDX-License-Identifier: Apache-2.0
// The accuracy of a new block, and its price, which the server states while the slider moves.

import { batch, signal } from '@preact/signals';
import { t } from '../../strings';
import { priceOf } from '../../link/lobby_requests';
import type { NamedProgram } from '../../link/lobby_requests';
import { motionPriceText, priceText, TARGET_DEFAULT_MM, TARGETS_MM } from '../../model/new_block';
import type { Scene } from '../../model/new_block';
import { sentence } from '../format';

export class Accuracy {
  readonly targetMm = signal(TARGET_DEFAULT_MM);
  /** The price, or why the block cannot be made. */
  readonly price = signal('');
  /** The price of a motion. */
  readonly motionPrice = signal('');
  /** Whether the last scene can be made. */
  readonly isPossible = signal(true);
  private asking_: AbortController | null = null;

  /**
   * Shows the price of a scene, or of a program in it. A later call replaces an earlier one that has
   * no answer yet.
   */
  async show(scene: Scene, program: NamedProgram | null): Promise<void> {
    this.asking_?.abort();
    const asking = new AbortController();
    this.asking_ = asking;
    const targetMm = this.targetMm.peek();
    try {
      const price = await priceOf(scene, program, asking.signal);
      if (this.asking_ === asking)
        this.tell_(priceText(price, targetMm), true, motionPriceText(price));
    } catch (problem) {
      if (this.asking_ === asking) this.tell_(sentence((problem as Error).message), false);
    }
  }

  private tell_(text: string, isPossible: boolean, motion = ''): void {
    batch(() => {
      this.price.value = text;
      this.motionPrice.value = motion;
      this.isPossible.value = isPossible;
    });
  }
}

export function AccuracyField({ accuracy }: { accuracy: Accuracy }) {
  const { value: targetMm } = accuracy.targetMm;
  const { value: isPossible } = accuracy.isPossible;
  return (
    <div class="accuracy">
      <span class="field-name">{t('Accuracy')}</span>
      <div class="accuracy-ends">
        <small>{t('coarse, fast')}</small>
        <input
          type="range"
          min={0}
          max={TARGETS_MM.length - 1}
          step={1}
          class="accuracy-slider"
          aria-label={t('Accuracy')}
          aria-valuetext={`${targetMm} mm`}
          value={Math.max(0, TARGETS_MM.indexOf(targetMm))}
          onInput={({ currentTarget }) =>
            (accuracy.targetMm.value = TARGETS_MM[Number(currentTarget.value)]!)
          }
        />
        <small>{t('fine, slow')}</small>
      </div>
      <p class={isPossible ? 'price' : 'price bad'} role="status">
        {accuracy.price.value}
      </p>
      <details class="quiet" hidden={!isPossible || accuracy.motionPrice.value === ''}>
        <summary>{t('Details')}</summary>
        <p>{accuracy.motionPrice.value}</p>
      </details>
    </div>
  );
}
