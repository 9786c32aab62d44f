// SPDX-License-Identifier: Apache-2.0
// The button of the take-home dialog, a chunk that is loaded when it is pressed.

import { t } from '../../strings';
import type { Amounts } from '../../model/take_home';
import { stockBounds } from '../../model/session';
import type { SessionModel } from '../../model/session';
import { h } from '../dom';
import { ICONS } from '../icons';

function amountsOf({ state, welcome }: SessionModel): Amounts {
  const motions = state?.motions ?? 0;
  if (!welcome) return { motions, columns: 0 };
  const { min, max } = stockBounds(welcome.stock);
  const along = (n: 0 | 1): number => (max[n] - min[n]) / welcome.pitch_mm;
  return { motions, columns: along(0) * along(1) };
}

export function takeHomeButton(model: SessionModel, session: string): HTMLElement {
  const button = h('button', { type: 'button', class: 'button take-button' }, t('Download…'));
  button.insertAdjacentHTML('afterbegin', ICONS.download);
  let dialog: Promise<{ open: () => void }> | null = null;
  button.addEventListener('click', () => {
    dialog ??= import('./dialog').then(
      ({ TakeHomeDialog }) =>
        new TakeHomeDialog(button.closest('main') ?? document.body, session, () =>
          amountsOf(model),
        ),
    );
    dialog.then(
      (one) => one.open(),
      (problem: unknown) => {
        dialog = null; // the next press tries again
        console.warn('The take-home dialog did not load:', problem);
      },
    );
  });
  return button;
}
