// SPDX-License-Identifier: Apache-2.0
// The view of the panel of programs. Text, path and plot draw themselves.

import { t } from '../../strings';
import type { ProgramInfo } from '../../wire/types';
import { Foreign } from '../foreign';
import { count, figure, volume } from '../format';
import { AlarmList } from './alarm_list';
import { Controls } from './controls';
import type { ControlActions } from './controls';
import { ProgramList } from './program_list';
import type { Alarm, ProgramDetails } from './requests';
import type { ProgramsState } from './state';
import { duration, watchText } from './texts';
import { Upload } from './upload';
import type { RunOptions } from './upload';

function figuresOf(program: ProgramInfo, details: ProgramDetails | undefined): string {
  const removed = volume(program.removed_volume_mm3).join(' ');
  const tools = details && details.tools.length > 1 ? t(' of {0}', details.tools.join(', ')) : '';
  return [
    t('{0} of {1} at feed rate, ', duration(program.elapsed_s), duration(program.programmed_s)) +
      t('line {0}, tool {1}{2}, ', count(program.line), program.tool, tools) +
      t('feed {0} mm/min, {1} removed.', figure(program.feed_mm_per_min), removed),
    ...(details?.readAs ? [t('Read as {0}.', details.readAs)] : []),
    ...(details?.target ? [watchText(details)] : []),
    ...(details?.warnings ?? []).slice(0, 3),
  ].join(' ');
}

export interface PanelActions extends ControlActions {
  close: () => void;
  send: (files: FileList | null) => void;
  select: (id: number) => void;
  showAlarm: (alarm: Alarm) => void;
  /** Moves the text to the live line, and with it. */
  follow: () => void;
}

interface PanelViewProps {
  state: ProgramsState;
  options: RunOptions;
  actions: PanelActions;
  text: HTMLElement;
  cut: HTMLElement;
  /** Null without a picture. */
  path: HTMLElement | null;
  /** Force and torque along the path; null without a picture. */
  wrench: HTMLElement | null;
}

/** The selected program. */
function One({ state, actions, cut, path, wrench }: PanelViewProps) {
  const { program, details } = state;
  const mayControl = state.may('run_programs') && details?.mayControl !== false;
  const { motions_done = 0, motions = 0 } = program ?? {};
  return (
    <div class="program-one" hidden={!program}>
      {program && <Controls program={program} may={mayControl} actions={actions} />}
      <progress
        max={1}
        aria-label={t('Progress')}
        value={motions === 0 ? 1 : motions_done / motions}
      />
      <p class="quiet program-figures">{program && figuresOf(program, details)}</p>
      {path && <Foreign element={path} />}
      {wrench && <Foreign element={wrench} />}
      <Foreign element={cut} />
      <AlarmList alarms={details?.alarms ?? []} press={actions.showAlarm} />
    </div>
  );
}

export function PanelView(props: PanelViewProps) {
  const { state, options, actions, text } = props;
  const { text: note, isBad } = state.note.value;
  return (
    <>
      <header>
        <h2>{t('NC programs')}</h2>
        <button type="button" class="button quiet-button" onClick={() => actions.close()}>
          {t('Close')}
        </button>
      </header>
      <Upload options={options} hidden={!state.may('run_programs')} send={actions.send} />
      <p class={isBad ? 'program-note bad' : 'program-note'} role="status">
        {note}
      </p>
      <ProgramList
        programs={state.programs}
        selected={state.selected.value}
        press={(id) => actions.select(id)}
      />
      <One {...props} />
      <Foreign element={text} />
      <button
        type="button"
        class="button quiet-button program-follow"
        hidden={state.follows.value}
        onClick={() => actions.follow()}
      >
        {t('Show current line')}
      </button>
    </>
  );
}
