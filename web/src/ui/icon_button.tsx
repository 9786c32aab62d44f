// SPDX-License-Identifier: Apache-2.0

import type { ComponentProps } from 'preact';

interface IconButtonProps extends Omit<ComponentProps<'button'>, 'icon'> {
  /** One of icons.ts. */
  icon: string;
  label: string;
  /** The keyboard shortcut, which the tooltip includes; missing or empty: none. */
  shortcut?: string;
  press: () => void;
}

/** A button with an icon and an accessible name. */
export function IconButton({ icon, label, shortcut = '', press, ...more }: IconButtonProps) {
  return (
    <button
      type="button"
      class="icon-button"
      aria-label={label}
      title={shortcut === '' ? label : `${label} (${shortcut})`}
      dangerouslySetInnerHTML={{ __html: icon }}
      onClick={press}
      {...more}
    />
  );
}
