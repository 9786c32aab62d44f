// SPDX-License-Identifier: Apache-2.0
// The buttons over the picture.

import { t } from '../strings';
import type { ButtonAction } from './actions';
import { IconButton } from './icon_button';
import type { Shell } from './shell';

function ActionButton({ shell, action }: { shell: Shell; action: ButtonAction }) {
  const reason = action.whyNot?.() ?? '';
  const isDisabled = action.whyNot ? reason !== '' : action.isDisabled?.();
  return (
    <IconButton
      icon={action.icon}
      label={action.label}
      shortcut={action.key}
      press={action.perform}
      ref={(button) => void shell.buttons.set(action.name, button)}
      {...(action.class === undefined ? {} : { class: `icon-button ${action.class}` })}
      {...(reason === '' ? {} : { title: `${action.label}: ${reason}` })}
      aria-description={reason === '' ? undefined : reason}
      aria-disabled={isDisabled}
      aria-pressed={action.isPressed?.()}
      aria-expanded={action.isExpanded?.()}
    />
  );
}

export function Toolbar({ shell, actions }: { shell: Shell; actions: readonly ButtonAction[] }) {
  return (
    <div
      class={shell.isSheetOpen.value ? 'toolbar covered' : 'toolbar'}
      role="toolbar"
      aria-label={t('View')}
    >
      {actions
        .filter(({ isShown }) => isShown?.() ?? true)
        .map((action) => (
          <ActionButton key={action.name} shell={shell} action={action} />
        ))}
    </div>
  );
}
