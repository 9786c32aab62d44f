// SPDX-License-Identifier: Apache-2.0
// The view of the panel of programs.

import { t } from '../../strings';
import type { ProgramInfo } from '../../wire/types';
import { useDrops } from '../drops';
import { count, figure, volume } from '../format';
import { ProgressBar } from '../progress_bar';
import { useCovering } from '../shell';
import type { Shell } from '../shell';
import { AlarmList } from './alarm_list';
import { Controls } from './controls';
import type { ControlActions } from './controls';
import type { CutControl } from './cut_control';
import type { PathControl } from './path_control';
import { PathRow } from './path_row';
import { ProgramList } from './program_list';
import type { Alarm, ProgramDetails } from './requests';
import type { ProgramsState } from './state';
import type { TextState } from './text_state';
import { TextView } from './text_view';
import { duration, watchText } from './texts';
import { Upload } from './upload';
import type { RunOptions } from './upload';
import type { WrenchControl } from './wrench_control';
import { WrenchRow } from './wrench_row';

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
  pressLine: (line: number) => void;
}

interface PanelViewProps {
  shell: Shell;
  state: ProgramsState;
  options: RunOptions;
  actions: PanelActions;
  text: TextState;
  cut: CutControl;
  /** Null without a picture. */
  path: PathControl | null;
  /** Null without a picture. */
  wrench: WrenchControl | null;
}

function Cut({ cut }: { cut: CutControl }) {
  const [View, curve] = [cut.plot.value, cut.curve.value];
  return (
    <div class="program-cut" hidden={!View || !curve}>
      {View && curve && <View control={cut} curve={curve} />}
    </div>
  );
}

/** The selected program. */
function One({ state, actions, cut, path, wrench }: PanelViewProps) {
  const { program, details } = state;
  const mayControl = state.may('run_programs') && details?.mayControl !== false;
  const { motions_done = 0, motions = 0 } = program ?? {};
  return (
    <div class="program-one" hidden={!program}>
      {program && <Controls program={program} may={mayControl} actions={actions} />}
      <ProgressBar share={motions === 0 ? 1 : motions_done / motions} />
      <p class="quiet program-figures">{program && figuresOf(program, details)}</p>
      {path && <PathRow path={path} />}
      {wrench && <WrenchRow wrench={wrench} />}
      <Cut key={program?.id} cut={cut} />
      <AlarmList alarms={details?.alarms ?? []} press={actions.showAlarm} />
    </div>
  );
}

export function PanelView(props: PanelViewProps) {
  const { shell, state, options, actions, text } = props;
  const { note } = state;
  const isOpen = state.isOpen.value;
  const element = useCovering<HTMLElement>(shell);
  const drops = useDrops(() => state.may('run_programs'), actions.send);
  return (
    <section
      ref={element}
      class={drops.isOver ? 'programs dropping' : 'programs'}
      aria-label={t('NC programs')}
      hidden={!isOpen}
      {...drops.handlers}
    >
      <header>
        <h2>{t('NC programs')}</h2>
        <button type="button" class="button quiet-button" onClick={() => actions.close()}>
          {t('Close')}
        </button>
      </header>
      <Upload options={options} hidden={!state.may('run_programs')} send={actions.send} />
      <p class={note.value.isBad ? 'program-note bad' : 'program-note'} role="status">
        {note.value.text}
      </p>
      <ProgramList
        programs={state.programs}
        selected={state.selected.value}
        press={(id) => actions.select(id)}
      />
      <One {...props} />
      <TextView state={text} pressed={actions.pressLine} />
      <button
        type="button"
        class="button quiet-button program-follow"
        hidden={text.follows.value}
        onClick={() => text.follow(true)}
      >
        {t('Show current line')}
      </button>
    </section>
  );
}
