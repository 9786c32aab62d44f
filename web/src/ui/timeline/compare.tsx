// SPDX-License-Identifier: Apache-2.0
// Compares two states by a border that is swiped over the picture: right of it the block is as it was
// when the button was pressed, left of it as the timeline shows it.

import { signal } from '@preact/signals';
import { t } from '../../strings';
import '../style/compare.css';
import { CompareView } from '../../view/compare_view';
import type { Picture } from '../picture';

const STEP = 0.02;

export class Compare {
  readonly isOn = signal(false);
  /** The place of the border, a share of the picture's width. */
  readonly part = signal(0.5);
  /** The name of the step that the timeline shows. */
  readonly place = signal('');
  /** The name of the step that is kept. */
  readonly kept = signal('');
  private view_: CompareView | null = null;

  constructor(private readonly picture: Picture) {}

  toggle(): void {
    if (this.view_) this.end();
    else this.begin_();
  }

  end(): void {
    this.view_?.dispose();
    this.view_ = null;
    this.isOn.value = false;
  }

  /** @param to a share of the picture's width */
  move(to: number): void {
    this.part.value = Math.min(1, Math.max(0, to));
    if (this.view_) this.view_.part = this.part.peek();
  }

  private begin_(): void {
    const { viewer } = this.picture;
    if (!viewer) return; // without a picture there is nothing to compare
    this.view_ = new CompareView(viewer);
    this.kept.value = this.place.peek();
    this.isOn.value = true;
    const [left, , right] = viewer.blockBox ?? [0, 0, 0, 0];
    this.move((left + right) / 2 / Math.max(1, this.picture.width));
  }
}

export function CompareButton({ compare }: { compare: Compare }) {
  return (
    <button
      type="button"
      class="timeline-action"
      title={t('Keep this state to compare it with another one')}
      aria-pressed={compare.isOn.value}
      onClick={() => compare.toggle()}
    >
      {t('Compare')}
    </button>
  );
}

/** The border; it lies below the panels. */
export function CompareBorder({ compare }: { compare: Compare }) {
  const percent = 100 * compare.part.value;
  return (
    <div
      class="compare-border"
      role="slider"
      tabIndex={0}
      hidden={!compare.isOn.value}
      style={`left:${percent}%`}
      aria-label={t('Divider between the two states')}
      aria-valuemin={0}
      aria-valuemax={100}
      aria-valuenow={Number(percent.toFixed(1))}
      onPointerDown={({ currentTarget, pointerId }) => currentTarget.setPointerCapture(pointerId)}
      onPointerMove={({ currentTarget, pointerId, clientX }) => {
        if (!currentTarget.hasPointerCapture(pointerId)) return;
        const { left, width } = currentTarget.parentElement!.getBoundingClientRect();
        compare.move((clientX - left) / width);
      }}
      onKeyDown={(event) => {
        const step = event.key === 'ArrowLeft' ? -STEP : event.key === 'ArrowRight' ? STEP : 0;
        if (step === 0) return;
        event.preventDefault();
        event.stopPropagation(); // the same keys turn the block
        compare.move(compare.part.peek() + step);
      }}
    >
      <span class="compare-now">{compare.place.value}</span>
      <span class="compare-kept">{compare.kept.value}</span>
    </div>
  );
}
