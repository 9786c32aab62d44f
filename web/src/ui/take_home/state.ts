// SPDX-License-Identifier: Apache-2.0
// A download that is being chosen, or is under way.

import { computed, signal } from '@preact/signals';
import { t } from '../../strings';
import { takeHome } from '../../link/take_home';
import type { Progress } from '../../link/take_home';
import { bytesText } from '../../model/new_block';
import { stockBounds } from '../../model/session';
import type { SessionModel } from '../../model/session';
import { choicesFor, fileOf, GROUPS, sizeOf } from '../../model/take_home';
import type { Amounts, DetailChoice, TakeHomeFormat } from '../../model/take_home';
import { sentence } from '../format';
import { saveFile } from '../save_file';

function amountsOf({ state, welcome }: SessionModel): Amounts {
  const motions = state?.motions ?? 0;
  if (!welcome) return { motions, columns: 0 };
  const { min, max } = stockBounds(welcome.stock);
  const along = (n: 0 | 1): number => (max[n] - min[n]) / welcome.pitch_mm;
  return { motions, columns: along(0) * along(1) };
}

function percent(share: number): string {
  return `${Math.floor(100 * share)} %`;
}

function progressText({ phase, share, bytes }: Progress): string {
  if (phase === 'coming') return t('Downloading: {0}', bytesText(bytes));
  return share === null ? t('Preparing the file…') : t('Preparing the file: {0}', percent(share));
}

export class TakeHomeState {
  readonly format = signal<TakeHomeFormat>(GROUPS[0]!.formats[0]!);
  /** The chosen one of `details`. */
  readonly detail = signal(0);
  readonly details = computed(() => choicesFor(this.format.value.detail));
  /** The greatest size of the file as a sentence; empty: unknown. */
  readonly size = computed(() => {
    const bytes = sizeOf(this.format.value, this.choice_, amountsOf(this.model));
    return bytes === null ? '' : t('up to about {0}', bytesText(bytes));
  });
  readonly isTaking = signal(false);
  /** The share that is done; null: unknown. */
  readonly share = signal<number | null>(null);
  readonly note = signal({ text: '', isBad: false });
  private taking_: AbortController | null = null;

  constructor(
    private readonly model: SessionModel,
    private readonly session: string,
  ) {}

  chooseFormat(format: TakeHomeFormat): void {
    this.format.value = format;
    this.detail.value = 0;
  }

  forgetNote(): void {
    this.say_('');
  }

  cancel(): void {
    this.taking_?.abort();
  }

  async take(): Promise<void> {
    if (this.taking_) return;
    const { signal: isAborted } = (this.taking_ = new AbortController());
    this.isTaking.value = true;
    this.share.value = null;
    try {
      const file = fileOf(this.format.value, this.choice_);
      const taken = await takeHome(this.session, file, isAborted, (progress) => {
        this.share.value = progress.share;
        this.say_(progressText(progress));
      });
      saveFile(taken.name, taken.content);
      const size = bytesText(taken.content.size);
      const done = t('{0} ({1}) is in your downloads.', taken.name, size);
      this.say_([done, ...taken.losses].join(' '));
    } catch (problem) {
      if (isAborted.aborted) this.say_(t('Cancelled.'));
      else this.say_(sentence((problem as Error).message), true);
    }
    this.taking_ = null;
    this.isTaking.value = false;
  }

  private get choice_(): DetailChoice {
    return this.details.value[this.detail.value]!;
  }

  private say_(text: string, isBad = false): void {
    this.note.value = { text, isBad };
  }
}
