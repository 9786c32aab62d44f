// SPDX-License-Identifier: Apache-2.0
// Compares two states by a border that is swiped over the picture: right of it the block is as it was
// when the button was pressed, left of it as the timeline shows it.

import { t } from '../../strings';
import '../style/compare.css';
import { CompareView } from '../../view/compare_view';
import { h, setText } from '../dom';
import type { Picture } from '../picture';

const STEP = 0.02;

export class Compare {
  readonly button = h('button', { type: 'button', class: 'timeline-action' }, t('Compare'));
  private readonly now_ = h('span', { class: 'compare-now' });
  private readonly kept_ = h('span', { class: 'compare-kept' });
  private readonly border_ = h(
    'div',
    {
      class: 'compare-border',
      role: 'slider',
      tabindex: '0',
      hidden: '',
      'aria-label': t('Divider between the two states'),
      'aria-valuemin': '0',
      'aria-valuemax': '100',
    },
    this.now_,
    this.kept_,
  );
  private view_: CompareView | null = null;
  private place_ = '';

  /** @param main of the page; the border lies below its panels */
  constructor(
    private readonly picture: Picture,
    main: Element,
  ) {
    this.button.title = t('Keep this state to compare it with another one');
    this.button.setAttribute('aria-pressed', 'false');
    main.querySelector('.overlay')?.after(this.border_);
    this.button.addEventListener('click', () => (this.view_ ? this.end() : this.begin_()));
    const { border_: border } = this;
    border.addEventListener('pointerdown', (event) => border.setPointerCapture(event.pointerId));
    border.addEventListener('pointermove', (event) => {
      const box = border.parentElement!.getBoundingClientRect();
      if (border.hasPointerCapture(event.pointerId))
        this.move_((event.clientX - box.left) / box.width);
    });
    border.addEventListener('keydown', (event) => {
      const step = event.key === 'ArrowLeft' ? -STEP : event.key === 'ArrowRight' ? STEP : 0;
      if (step === 0) return;
      event.preventDefault();
      event.stopPropagation(); // the same keys turn the block
      this.move_(this.part_ + step);
    });
  }

  /** Takes the name of the step that the timeline shows. */
  show(place: string): void {
    this.place_ = place;
    if (this.view_) setText(this.now_, place);
  }

  end(): void {
    this.view_?.dispose();
    this.view_ = null;
    this.border_.hidden = true;
    this.button.setAttribute('aria-pressed', 'false');
  }

  private get part_(): number {
    return Number(this.border_.getAttribute('aria-valuenow')) / 100;
  }

  private begin_(): void {
    const { viewer } = this.picture;
    if (!viewer) return; // without a picture there is nothing to compare
    this.view_ = new CompareView(viewer);
    setText(this.kept_, this.place_);
    setText(this.now_, this.place_);
    this.border_.hidden = false;
    this.button.setAttribute('aria-pressed', 'true');
    const [left, , right] = viewer.blockBox ?? [0, 0, 0, 0];
    this.move_((left + right) / 2 / Math.max(1, this.border_.parentElement!.clientWidth));
  }

  private move_(to: number): void {
    const part = Math.min(1, Math.max(0, to));
    this.border_.style.left = `${100 * part}%`;
    this.border_.setAttribute('aria-valuenow', (100 * part).toFixed(1));
    if (this.view_) this.view_.part = part;
  }
}
