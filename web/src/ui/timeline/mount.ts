// SPDX-License-Identifier: Apache-2.0
// The button that opens the timeline. The timeline is a chunk of its own.

import { t } from '../../strings';
import { iconButton } from '../dom';
import { ICONS } from '../icons';
import { lazyPanel } from '../lazy_panel';
import type { TimelineHost } from './host';

/** Adds the button to the toolbar. Returns its action. */
export function mountTimeline(host: TimelineHost): () => void {
  const toggle = lazyPanel('timeline', async () => {
    const { Timeline } = await import('./timeline');
    return new Timeline(host, button);
  });
  const button = iconButton(ICONS.timeline, t('Timeline'), 'T', toggle);
  button.setAttribute('aria-expanded', 'false');
  host.toolbar.firstElementChild?.after(button);
  return toggle;
}
