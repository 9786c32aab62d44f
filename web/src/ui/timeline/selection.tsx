// SPDX-License-Identifier: Apache-2.0
// The selected stroke: whose it is, and its undo or redo.

import { language, t } from '../../strings';
import type { Stroke, StrokeChange } from '../../model/stroke';

export const CLOCK = new Intl.DateTimeFormat(language, { timeStyle: 'medium', hourCycle: 'h23' });

interface SelectionProps {
  stroke: Stroke | null;
  author: string;
  tool: string;
  /** Why this viewer may not undo; empty: it may. */
  whyNot: string;
  note: string;
  change: (change: StrokeChange, stroke: Stroke) => void;
}

export function Selection({ stroke, author, tool, whyNot, note, change }: SelectionProps) {
  return (
    <p class="timeline-selection">
      <span>
        {stroke
          ? `${author} · ${tool} · ${CLOCK.format(stroke.begin_ms)}${stroke.undone ? t(' · undone') : ''}`
          : t('Click a bar to select its stroke.')}
      </span>
      {stroke && (
        <button
          type="button"
          class="timeline-action"
          aria-label={
            stroke.undone
              ? t('Redo this stroke by {0}', author)
              : t('Undo this stroke by {0}', author)
          }
          disabled={whyNot !== ''}
          title={whyNot}
          onClick={() => change(stroke.undone ? 'redo' : 'undo', stroke)}
        >
          {stroke.undone ? t('Redo') : t('Undo')}
        </button>
      )}
      <span class="timeline-note" role="status">
        {note}
      </span>
    </p>
  );
}
