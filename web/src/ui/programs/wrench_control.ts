// SPDX-License-Identifier: Apache-2.0
// Force and torque along the path of the selected program in the picture: shown or not, and the
// values of the longest arrows.

import { computed, effect, signal } from '@preact/signals';
import type { ReadonlySignal } from '@preact/signals';
import { greatestOf, thinned } from '../../model/wrench_path';
import type { WrenchPeak } from '../../model/wrench_path';
import { WrenchPathView } from '../../view/wrench_path_view';
import type { Picture } from '../picture';

/** More arrows would cover each other. */
const ARROWS_MAX = 120;

export class WrenchControl {
  /** Whether the user wants to see the arrows. */
  readonly isWanted = signal(false);
  private readonly drawn_ = computed(() => thinned(this.peaks.value, ARROWS_MAX));
  /** The values of the longest arrows; null: the program has none, or they are not known yet. */
  readonly greatest = computed(() =>
    this.drawn_.value.length === 0 ? null : greatestOf(this.drawn_.value),
  );
  private view_: WrenchPathView | null = null;

  /**
   * @param isOpen the arrows are drawn while the panel is open
   * @param peaks of the selected program
   * @param lengthMm of the longest arrow, which depends on the block; it is tracked as signals are
   */
  constructor(
    private readonly picture: Picture,
    private readonly isOpen: ReadonlySignal<boolean>,
    private readonly peaks: ReadonlySignal<readonly WrenchPeak[]>,
    private readonly lengthMm: () => number,
  ) {
    effect(() => this.draw_());
  }

  private draw_(): void {
    const isShown = this.isOpen.value && this.isWanted.value;
    const { viewer } = this.picture;
    if (!viewer || (!isShown && !this.view_)) return;
    this.view_ ??= new WrenchPathView(viewer);
    this.view_.show(isShown ? this.drawn_.value : [], this.lengthMm());
  }
}
