// SPDX-License-Identifier: Apache-2.0

import { t } from '../../strings';
import type { Action } from '../actions';
import type { History } from './state';

/** Undo and redo of the selected participant's strokes. */
export function historyActions(history: History): [undo: Action, redo: Action] {
  const whyNot = (): string => history.whyNot;
  return [
    {
      ...{ name: 'undo', label: t('Undo'), key: 'Ctrl+Z', whyNot },
      perform: () => void history.change('undo'),
    },
    {
      ...{ name: 'redo', label: t('Redo'), key: 'Ctrl+Shift+Z', whyNot },
      perform: () => void history.change('redo'),
    },
  ];
}
