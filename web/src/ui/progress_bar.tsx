// SPDX-License-Identifier: Apache-2.0

import { t } from '../strings';

interface ProgressBarProps {
  /** 0 to 1; null: unknown. */
  share: number | null;
  hidden?: boolean;
}

/** How far something is. */
export function ProgressBar({ share, hidden = false }: ProgressBarProps) {
  const known = share === null ? {} : { value: share };
  // A bar that had a value does not become indeterminate again: there are two.
  return (
    <progress
      key={share === null ? 'unknown' : 'known'}
      max={1}
      aria-label={t('Progress')}
      hidden={hidden}
      {...known}
    />
  );
}
