// SPDX-License-Identifier: Apache-2.0
// Whether force and torque are drawn along the path of the selected program, and the values of the
// longest arrows.

import { t } from '../../strings';
import { WRENCH_COLORS } from '../../model/arrow_scale';
import { greatestOf, thinned } from '../../model/wrench_path';
import type { WrenchPeak } from '../../model/wrench_path';
import { WrenchPathView } from '../../view/wrench_path_view';
import { h, setText } from '../dom';
import { figure } from '../format';
import type { Picture } from '../picture';

/** More arrows would cover each other. */
const ARROWS_MAX = 120;

export class WrenchControl {
  private readonly shown_ = h('input', { type: 'checkbox' });
  private readonly force_ = h('span', {
    class: 'path-key',
    style: `--line:${WRENCH_COLORS.force}`,
  });
  private readonly torque_ = h('span', {
    class: 'path-key',
    style: `--line:${WRENCH_COLORS.torque}`,
  });
  readonly element = h(
    'p',
    { class: 'program-path', hidden: '' },
    h('label', {}, this.shown_, t(' Show force and torque')),
    this.force_,
    this.torque_,
  );
  private view_: WrenchPathView | null = null;
  private peaks_: readonly WrenchPeak[] = [];
  private isOpen_ = false;

  /** @param lengthMm of the longest arrow, which depends on the block */
  constructor(
    private readonly picture: Picture,
    private readonly lengthMm: () => number,
  ) {
    this.shown_.addEventListener('change', () => this.draw_());
  }

  /** The arrows are drawn while the panel is open. */
  setOpen(open: boolean): void {
    this.isOpen_ = open;
    this.draw_();
  }

  /** Shows the peaks of the selected program; empty: it has none, or they are not known yet. */
  show(peaks: readonly WrenchPeak[]): void {
    this.peaks_ = thinned(peaks, ARROWS_MAX);
    this.element.hidden = peaks.length === 0;
    const { forceN, torqueNmm } = greatestOf(this.peaks_);
    setText(this.force_, t('up to {0}', `${figure(forceN)} N`));
    setText(this.torque_, t('up to {0}', `${figure(torqueNmm)} N·mm`));
    this.draw_();
  }

  private draw_(): void {
    const isShown = this.isOpen_ && this.shown_.checked;
    const { viewer } = this.picture;
    if (!viewer || (!isShown && !this.view_)) return;
    this.view_ ??= new WrenchPathView(viewer);
    this.view_.show(isShown ? this.peaks_ : [], this.lengthMm());
  }
}
