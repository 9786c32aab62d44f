// SPDX-License-Identifier: Apache-2.0
// The action that opens the timeline. The timeline is a chunk of its own.

import type { VNode } from 'preact';
import { t } from '../../strings';
import type { ButtonAction } from '../actions';
import { ICONS } from '../icons';
import { LazyPanel } from '../lazy_panel';
import { Live } from '../live';
import type { TimelineHost } from './host';
import type { Timeline } from './timeline';

export class TimelinePart {
  readonly action: ButtonAction;
  private readonly panel_: LazyPanel<Timeline>;
  private wanted_: number | null = null; // the participant whose strokes are to be played

  constructor(private readonly host: TimelineHost) {
    this.panel_ = new LazyPanel('timeline', async () => {
      const { Timeline } = await import('./timeline');
      const timeline = new Timeline(host);
      if (this.wanted_ !== null) timeline.playStrokesOf(this.wanted_);
      return timeline;
    });
    this.action = {
      ...{ name: 'timeline', label: t('Timeline'), key: 'T', icon: ICONS.timeline },
      isExpanded: () => host.shell.isTimelineOpen.value,
      perform: () => this.panel_.toggle(),
    };
  }

  view(): VNode {
    return <Live view={() => this.panel_.loaded?.view()} />;
  }

  /** The border between two states that are compared. */
  border(): VNode {
    return <Live view={() => this.panel_.loaded?.border()} />;
  }

  /** Opens the timeline and plays the strokes of a participant. */
  playStrokesOf(participant: number): void {
    this.wanted_ = participant;
    this.panel_.loaded?.playStrokesOf(participant);
    if (!this.host.shell.isTimelineOpen.peek()) this.panel_.toggle();
  }

  stopPlaying(): void {
    this.wanted_ = null;
    this.panel_.loaded?.stopPlaying();
  }
}
