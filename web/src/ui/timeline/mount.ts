// SPDX-License-Identifier: Apache-2.0
// The button that opens the timeline. The timeline is a chunk of its own.

import { t } from '../../strings';
import { iconButton } from '../dom';
import { ICONS } from '../icons';
import { lazyPanel } from '../lazy_panel';
import type { TimelineHost } from './host';
import type { Timeline } from './timeline';

export interface TimelineSwitch {
  toggle: () => void;
  /** Opens the timeline and plays the strokes of a participant. */
  playStrokesOf: (participant: number) => void;
  stopPlaying: () => void;
}

/** Adds the button to the toolbar. */
export function mountTimeline(host: TimelineHost): TimelineSwitch {
  let wanted: number | null = null;
  let timeline: Timeline | null = null;
  const toggle = lazyPanel('timeline', async () => {
    const { Timeline } = await import('./timeline');
    timeline = new Timeline(host, button);
    if (wanted !== null) timeline.playStrokesOf(wanted);
    return timeline;
  });
  const button = iconButton(ICONS.timeline, t('Timeline'), 'T', toggle);
  button.setAttribute('aria-expanded', 'false');
  host.toolbar.firstElementChild?.after(button);
  const playStrokesOf = (participant: number): void => {
    wanted = participant;
    timeline?.playStrokesOf(participant);
    if (button.getAttribute('aria-expanded') !== 'true') toggle();
  };
  const stopPlaying = (): void => {
    wanted = null;
    timeline?.stopPlaying();
  };
  return { toggle, playStrokesOf, stopPlaying };
}
