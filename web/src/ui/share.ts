// SPDX-License-Identifier: Apache-2.0
// Brings others to the session: an invitation where one is needed and may be made, else the link.

import { t } from '../strings';
import type { SessionModel } from '../model/session';
import type { ButtonAction } from './actions';
import { ICONS } from './icons';

interface Shares {
  /** Copies the address of the page. */
  copy: () => void;
  /** Opens the dialog of invitations. */
  invite: () => void;
}

export function shareAction(model: SessionModel, { copy, invite }: Shares): ButtonAction {
  return {
    ...{ name: 'share', label: t('Share'), key: '', icon: ICONS.invite },
    perform: () => {
      if (model.welcome?.may?.includes('invite')) invite();
      else copy();
    },
  };
}
