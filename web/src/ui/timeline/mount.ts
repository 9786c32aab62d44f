// SPDX-License-Identifier: Apache-2.0
// The button that opens the timeline. The timeline is a chunk of its own.

import { t } from '../../strings';
import type { SessionModel } from '../../model/session';
import type { Seek } from '../../wire/types';
import { iconButton } from '../dom';
import { ICONS } from '../icons';
import { lazyPanel } from '../lazy_panel';
import type { Picture } from '../picture';

/** What the timeline needs of the page. */
export interface TimelineHost {
  model: SessionModel;
  session: string;
  picture: Picture;
  toolbar: HTMLElement;
  seek: (seek: Seek) => void;
  /** It was opened or closed, and covers another part of the picture. */
  layoutChanged: () => void;
}

/** Adds the button to the toolbar; returns what it does. */
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
