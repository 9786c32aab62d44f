// SPDX-License-Identifier: Apache-2.0
// The buttons that undo and redo strokes, and the list of strokes, a chunk that is loaded when it is
// opened first.

import { useSignal, useSignalEffect } from '@preact/signals';
import { t } from '../../strings';
import type { Action } from '../actions';
import { historyActions } from './actions';
import type { History } from './state';
import type { StrokeList } from './stroke_list';

interface ButtonProps {
  action: Action;
  title: string;
  isDisabled: boolean;
}

function ChangeButton({ action: { label, perform }, title, isDisabled }: ButtonProps) {
  return (
    <button
      type="button"
      class="history-button"
      title={title}
      aria-disabled={isDisabled}
      onClick={perform}
    >
      {label}
    </button>
  );
}

export function HistoryView({ history }: { history: History }) {
  const [undo, redo] = historyActions(history);
  const isDisabled = history.whyNot !== '' || history.isBusy.value;
  const isOpen = history.isListOpen.value;
  const undoTitle = t("Undo the selected participant's last stroke ({0})", t('Ctrl+Z'));
  const redoTitle = t("Redo the selected participant's last stroke ({0})", t('Ctrl+Shift+Z'));
  const list = useSignal<typeof StrokeList | null>(null);
  useSignalEffect(() => {
    if (!history.isListOpen.value || list.peek()) return;
    import('./stroke_list').then(
      ({ StrokeList }) => (list.value = StrokeList),
      (problem: unknown) => console.warn('The list of strokes did not load:', problem),
    );
  });
  const List = list.value;
  return (
    <div>
      <div class="history-actions">
        <ChangeButton action={undo} title={undoTitle} isDisabled={isDisabled} />
        <ChangeButton action={redo} title={redoTitle} isDisabled={isDisabled} />
        <button
          type="button"
          class="quiet-action"
          aria-expanded={isOpen}
          onClick={() => void history.toggleList()}
        >
          {isOpen ? t('Hide strokes') : t('Show strokes')}
        </button>
      </div>
      <p class="quiet history-note" role="status">
        {history.note}
      </p>
      <div hidden={!isOpen}>{List && <List history={history} />}</div>
    </div>
  );
}
