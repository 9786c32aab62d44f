// SPDX-License-Identifier: Apache-2.0

import type { ComponentProps } from 'preact';
import { t } from '../../strings';
import { useCovering } from '../shell';
import type { Shell } from '../shell';
import { Banner } from './banner';
import { CompareButton } from './compare';
import type { Compare } from './compare';
import { Selection } from './selection';
import { StripView } from './strip';
import { TransportView } from './transport';
import type { Transport } from './transport';
import { Versions } from './versions';
import type { VersionsProps } from './versions';

interface TimelineViewProps {
  shell: Shell;
  /** The name of the place in the past; null: the picture shows the present. */
  place: string | null;
  /** The length of the journal; empty in the past. */
  where: string;
  back: () => void;
  transport: Transport;
  strip: Omit<ComponentProps<typeof StripView>, 'hasFocus'>;
  selection: ComponentProps<typeof Selection>;
  versions: VersionsProps;
  compare: Compare;
}

/** The timeline, and the banner of the past, which stays when the timeline is closed. */
export function TimelineView(props: TimelineViewProps) {
  const { shell, place, where, back, transport, strip, selection, versions, compare } = props;
  const element = useCovering<HTMLElement>(shell, '--timeline');
  const isOpen = shell.isTimelineOpen.value;
  return (
    <>
      <Banner shell={shell} place={place} back={back} />
      <section ref={element} class="timeline" aria-label={t('Timeline')} hidden={!isOpen}>
        <div class="timeline-controls">
          <TransportView transport={transport} />
          <p class="timeline-where">{where}</p>
        </div>
        <StripView {...strip} hasFocus={isOpen} />
        <div class="timeline-foot">
          <Selection {...selection} />
          <div class="timeline-bookmarks" role="group" aria-label={t('Versions and branches')}>
            <Versions {...versions} />
            <CompareButton compare={compare} />
          </div>
        </div>
      </section>
    </>
  );
}
