// SPDX-License-Identifier: Apache-2.0
// The buttons with words: the actions that everyone looks for first.

import { t } from '../strings';
import type { ButtonAction } from './actions';
import type { Shell } from './shell';

function MainButton({ shell, action }: { shell: Shell; action: ButtonAction }) {
  const { name, label, key, icon } = action;
  const reason = action.whyNot?.() ?? '';
  const hint = key === '' ? label : `${label} (${key})`;
  return (
    <button
      type="button"
      class={`main-action main-action-${name}`}
      title={reason === '' ? hint : `${label}: ${reason}`}
      ref={(button) => void shell.buttons.set(name, button)}
      aria-description={reason === '' ? undefined : reason}
      aria-disabled={reason !== '' || action.isDisabled?.() === true}
      onClick={action.perform}
    >
      <span aria-hidden="true" dangerouslySetInnerHTML={{ __html: icon }} />
      {label}
    </button>
  );
}

/** Shows those of the actions that apply now. */
export function MainActions({
  shell,
  actions,
}: {
  shell: Shell;
  actions: readonly ButtonAction[];
}) {
  const shown = actions.filter(({ isShown }) => isShown?.() ?? true);
  if (shown.length === 0) return null;
  return (
    <div
      class={shell.isSheetOpen.value ? 'main-actions covered' : 'main-actions'}
      role="group"
      aria-label={t('Main actions')}
    >
      {shown.map((action) => (
        <MainButton key={action.name} shell={shell} action={action} />
      ))}
    </div>
  );
}
