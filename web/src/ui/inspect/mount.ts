// SPDX-License-Identifier: Apache-2.0
// The button that opens the panel for sections and measures. The panel is a chunk of its own.

import { t } from '../../strings';
import { iconButton } from '../dom';
import { ICONS } from '../icons';
import { lazyPanel } from '../lazy_panel';
import type { InspectHost } from './host';

/** Adds the button to the toolbar. Returns its action. */
export function mountInspect(host: InspectHost): () => void {
  const open = lazyPanel('panel', async () => {
    const { InspectPanel } = await import('./inspect_panel');
    return new InspectPanel(host, host.picture.viewer!, button);
  });
  const toggle = (): void => {
    if (host.picture.viewer) open(); // without a picture there is nothing to inspect
  };
  const button = iconButton(ICONS.inspect, t('Sections and measurements'), 'I', toggle);
  button.setAttribute('aria-expanded', 'false');
  host.toolbar.firstElementChild?.after(button);
  return toggle;
}
