// SPDX-License-Identifier: Apache-2.0
// The dialog by which one takes the block home from the page without a server.

import type { Signal } from '@preact/signals';
import { t } from '../strings';
import type { ButtonAction } from '../ui/actions';
import { Dialog } from '../ui/dialog';
import { ICONS } from '../ui/icons';
import { NameField } from './name_field';
import type { SideActions } from './side_panel';
import type { LocalState } from './state';

export function downloadAction(state: LocalState, isOpen: Signal<boolean>): ButtonAction {
  return {
    ...{ name: 'download', label: t('Download'), key: '', icon: ICONS.download },
    isDisabled: () => state.about.value === null,
    perform: () => (isOpen.value = state.about.peek() !== null),
  };
}

interface DownloadDialogProps {
  state: LocalState;
  isOpen: Signal<boolean>;
  actions: Pick<SideActions, 'takeHome' | 'save'>;
}

interface FormatProps {
  label: string;
  text: string;
  isDisabled: boolean;
  press: () => void;
}

function Format({ label, text, isDisabled, press }: FormatProps) {
  return (
    <p class="download-row">
      <button type="button" class="button" disabled={isDisabled} onClick={press}>
        {label}
      </button>
      <span>{text}</span>
    </p>
  );
}

export function DownloadDialog({ state, isOpen, actions }: DownloadDialogProps) {
  const isDisabled = !state.canSave.value;
  const hasJournal = state.hasJournal.value;
  return (
    <Dialog class="help download" label={t('Download')} isOpen={isOpen} closesOutside>
      <h2>{t('Download')}</h2>
      <Format
        {...{ label: 'STL', isDisabled, press: () => actions.takeHome('stl') }}
        text={t('The shape, for 3D printing and CAD')}
      />
      <Format
        {...{ label: '3MF', isDisabled, press: () => actions.takeHome('3mf') }}
        text={t('The shape with its unit, in a smaller file')}
      />
      {hasJournal && (
        <>
          <Format
            {...{ label: 'KERF', isDisabled, press: actions.save }}
            text={t('The block with all strokes, to carve on here or in kerf-server')}
          />
          <NameField hidden={false} />
        </>
      )}
      <form method="dialog" class="help-end">
        <button class="button quiet-button">{t('Close')}</button>
      </form>
    </Dialog>
  );
}
