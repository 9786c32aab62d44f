// SPDX-License-Identifier: Apache-2.0
// The side panel: figures, participants, plots, downloads, material.

import type { ReadonlySignal } from '@preact/signals';
import { useMemo, useRef } from 'preact/hooks';
import { t } from '../strings';
import { pageAddress } from '../link/request';
import type { Participant } from '../model/participants';
import type { SessionModel } from '../model/session';
import { connectionText } from '../ui/badge';
import { CapMouseChoice } from '../carve/devices/cap_mouse';
import type { CapMouseHost } from '../carve/devices/cap_mouse';
import { LanguageChoice } from '../ui/language_choice';
import { Details, Figure, Section } from '../ui/figures';
import { count, duration, figure, volume } from '../ui/format';
import { HistoryView } from '../ui/history/view';
import type { History } from '../ui/history/state';
import { MaterialChoice } from '../ui/material_choice';
import { marks } from '../model/marks';
import { CheckBadge } from '../replay/badge';
import { checkOf } from '../replay/part';
import { NavigationChoice } from '../ui/navigation_choice';
import { PanelFrame } from '../ui/panel_frame';
import { People } from '../ui/people';
import type { PersonChoice } from '../ui/person_choice';
import type { Picture } from '../ui/picture';
import { PlotSpot } from '../ui/plot_spot';
import type { PlotsProps } from '../ui/plots';
import type { Shell } from '../ui/shell';
import type { TogetherPart } from '../ui/together/part';

const SILENT_MS = 1500; // without a tool state for so long, there is no newest force

interface Sampled {
  model: SessionModel;
  /** The time at which forces and delays are sampled, ms. */
  nowMs: ReadonlySignal<number>;
}

interface ForcesProps extends Sampled {
  picture: Picture;
  choice: PersonChoice;
  colors: PlotsProps['colors'];
}

/** Plots the forces of the selected participant, also after it has left. */
function Forces({ model, picture, choice, colors, nowMs }: ForcesProps) {
  const { participants } = model;
  const last = useRef<Participant | null>(null); // stays when the participant leaves
  const { selected } = choice;
  last.current = (selected === null ? undefined : participants.get(selected)) ?? last.current;
  // The first picture does not need the code of plots, which is loaded after it.
  const hasStarted = marks.picture !== undefined || picture.problem !== '';
  const { value: now } = nowMs;
  const { current: plotted } = last;
  if (!plotted || !hasStarted)
    return (
      <Section title={t('Forces')} about={<span class="plot-of" />}>
        <PlotSpot plotted={null} />
      </Section>
    );
  const { info, seenMs, forces, feltShare } = plotted;
  const silentMs = now - seenMs;
  const isGone = !participants.get(info.participant) && Number.isFinite(silentMs);
  const ago = isGone ? t(', {0} ago', duration(silentMs)) : '';
  const felt = silentMs > SILENT_MS ? 'gone' : feltShare;
  return (
    <Section title={t('Forces')} about={<span class="plot-of">{info.name + ago}</span>}>
      <PlotSpot plotted={{ colors, history: forces, nowS: now / 1000, felt }} />
    </Section>
  );
}

/** Figures of the block, its state hash, and the connection. */
function BlockDetails({ model, nowMs }: Sampled) {
  const { state, welcome, tiles } = model;
  const { value: now } = nowMs;
  const isComplete = state?.settled === true && tiles.complete && !model.lag.isBehind(now);
  return (
    <Details>
      <dl class="figures">
        <Figure label={t('Motions')} value={state ? count(state.motions) : '–'} />
        <Figure label={t('Triangles')} value={count(tiles.triangles)} />
        <Figure
          label={t('Grid spacing')}
          value={welcome ? figure(welcome.pitch_mm) : '–'}
          unit="mm"
        />
      </dl>
      <p class="quiet hash">
        {t('State hash ')}
        <code
          class={isComplete ? 'settled' : ''}
          title={t('State hash: the same hash means the same block')}
          data-settled={t('complete')}
        >
          {state?.state_hash ?? '–'}
        </code>
      </p>
      <p class="quiet hash" title={t('Connection')}>
        {connectionText(model, now)}
      </p>
    </Details>
  );
}

interface PanelProps extends ForcesProps {
  shell: Shell;
  session: string;
  history: History;
  together: TogetherPart;
  /** The viewer has chosen another name. */
  renamed: (name: string) => void;
  /** The camera that a 3D mouse moves. */
  capMouse: CapMouseHost;
}

export function Panel(props: PanelProps) {
  const { shell, model, session, picture, choice, nowMs, renamed } = props;
  const { state } = model;
  const check = useMemo(() => checkOf(session, model, () => picture.viewer), [session]);
  const [removed, unit] = state ? volume(state.removed_volume_mm3) : ['–', ''];
  return (
    <PanelFrame shell={shell} label={t('Session')}>
      <dl class="figures">
        <Figure label={t('Removed')} value={removed} unit={unit} />
      </dl>
      <Section title={t('Participants')}>
        <People {...{ model, choice, nowMs, renamed }} />
      </Section>
      {props.together.section()}
      <Forces {...{ model, picture, choice, nowMs }} colors={props.colors} />
      <Section title={t('History')}>
        <HistoryView history={props.history} />
      </Section>
      <Section title={t('Material')}>
        <MaterialChoice picture={picture} participants={model.participants} />
      </Section>
      {check && (
        <p class="quiet hash">
          <CheckBadge check={check} />
        </p>
      )}
      <BlockDetails model={model} nowMs={nowMs} />
      <div class="preferences">
        <LanguageChoice reload={() => location.assign(pageAddress())} />
        <NavigationChoice picture={picture} />
        <CapMouseChoice host={props.capMouse} />
      </div>
    </PanelFrame>
  );
}
