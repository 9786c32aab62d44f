// SPDX-License-Identifier: Apache-2.0
// The buttons of the section, and its lists of shared views and of pins once their code is loaded.

import type { ReadonlySignal } from '@preact/signals';
import { t } from '../../strings';
import { Section } from '../figures';
import type { TogetherHost } from './host';
import type { TogetherState } from './state';
import type { TogetherPanel } from './together_panel';

export type Command = 'setPin' | 'share' | 'savePicture' | 'saveVideo';

interface SectionProps {
  host: TogetherHost;
  state: TogetherState;
  /** Null until it is loaded. */
  panel: ReadonlySignal<TogetherPanel | null>;
  press: (command: Command) => void;
}

export function TogetherSection({ host, state, panel, press }: SectionProps) {
  const { welcome } = host.model;
  const maySetPins = welcome?.may === undefined || welcome.may.includes('place_pins');
  const recorded = state.recorded.value;
  const button = (command: Command) => ({
    type: 'button' as const,
    class: 'history-button',
    'aria-disabled': host.picture.viewer === null,
    onClick: () => {
      if (host.picture.viewer) press(command);
    },
  });
  return (
    <Section title={t('Pins and pictures')}>
      <div class="history-actions together-actions">
        <button
          {...button('setPin')}
          title={t('Attach a note to a spot on the block, for everyone')}
          aria-pressed={host.shell.isAiming.value}
          hidden={!maySetPins}
        >
          {t('Add a pin')}
        </button>
        <button
          {...button('share')}
          title={t('Let others follow your view')}
          aria-pressed={state.isShared.value}
        >
          {t('Share my view')}
        </button>
        <button {...button('savePicture')} title={t('PNG, 3840 pixels wide')}>
          {t('Save picture')}
        </button>
        <button {...button('saveVideo')} title={t('MP4: the block turns once')}>
          {recorded === null
            ? t('Save video')
            : t('Cancel video, {0} %', Math.round(100 * recorded))}
        </button>
      </div>
      <ul class="shown-cameras" aria-label={t('Shared views')}>
        {panel.value?.cameraRows()}
      </ul>
      <ul class="pins" aria-label={t('Pins')}>
        {panel.value?.pinRows()}
      </ul>
    </Section>
  );
}
