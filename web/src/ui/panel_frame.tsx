// SPDX-License-Identifier: Apache-2.0
// The panel at the side of the picture, which is a sheet at the bottom on phones.

import type { ComponentChildren } from 'preact';
import { t } from '../strings';
import { useCovering } from './shell';
import type { Shell } from './shell';

interface PanelFrameProps {
  shell: Shell;
  label: string;
  children: ComponentChildren;
}

export function PanelFrame({ shell, label, children }: PanelFrameProps) {
  const element = useCovering<HTMLElement>(shell);
  const isOpen = shell.isSheetOpen.value;
  return (
    <aside ref={element} class={isOpen ? 'panel open' : 'panel'} aria-label={label}>
      <button
        type="button"
        class="sheet-handle"
        aria-expanded={isOpen}
        onClick={() => (shell.isSheetOpen.value = !isOpen)}
      >
        {isOpen ? t('Show less') : t('Show more')}
      </button>
      <div class="panel-scroll">{children}</div>
    </aside>
  );
}
