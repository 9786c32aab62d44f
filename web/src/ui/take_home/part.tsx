// SPDX-License-Identifier: Apache-2.0
// The action that opens the dialog of downloads. The dialog is a chunk that is loaded with the first
// press.

import { signal } from '@preact/signals';
import type { VNode } from 'preact';
import { t } from '../../strings';
import type { SessionModel } from '../../model/session';
import type { ButtonAction } from '../actions';
import { ICONS } from '../icons';
import { Live } from '../live';
import type { TakeHomeDialog } from './dialog';

export class TakeHomePart {
  /** Opens the dialog. */
  readonly action: ButtonAction = {
    ...{ name: 'download', label: t('Download'), key: '', icon: ICONS.download },
    perform: () => void this.open(),
  };
  private readonly isOpen_ = signal(false);
  private readonly dialog_ = signal<typeof TakeHomeDialog | null>(null);

  constructor(
    private readonly model: SessionModel,
    private readonly session: string,
  ) {}

  /** Opens the dialog. A chunk that did not load is loaded again by the next call. */
  async open(): Promise<void> {
    try {
      const { TakeHomeDialog } = await import('./dialog');
      this.dialog_.value = TakeHomeDialog;
      this.isOpen_.value = true;
    } catch (problem) {
      console.warn('The dialog of downloads did not load:', problem);
    }
  }

  dialog(): VNode {
    const { model, session, isOpen_: isOpen, dialog_: loaded } = this;
    const view = (): VNode | null => {
      const Dialog = loaded.value;
      return Dialog && <Dialog {...{ model, session, isOpen }} />;
    };
    return <Live view={view} />;
  }
}
