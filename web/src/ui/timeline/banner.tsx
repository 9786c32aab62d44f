// SPDX-License-Identifier: Apache-2.0

import { t } from '../../strings';
import { useCovering } from '../shell';
import type { Shell } from '../shell';

interface BannerProps {
  shell: Shell;
  /** Which point of the past is shown, and who carved there; null: the picture shows the present. */
  place: string | null;
  back: () => void;
}

/** The banner over the picture while it shows the past, with the button that leads back. */
export function Banner({ shell, place, back }: BannerProps) {
  const element = useCovering<HTMLDivElement>(shell);
  return (
    <div ref={element} class="past-banner" hidden={place === null}>
      <span role="status">
        <b>{t('The past')}</b>
      </span>
      <span class="past-place">{place}</span>
      <button type="button" class="past-back" onClick={back}>
        {t('Back to live')}
      </button>
    </div>
  );
}
