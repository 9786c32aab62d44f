// SPDX-License-Identifier: Apache-2.0
// The side panel of the page without a server: files, how far the program is, its text, figures,
// downloads.

import type { ReadonlySignal } from '@preact/signals';
import { useMemo } from 'preact/hooks';
import { t } from '../strings';
import '../ui/style/programs.css';
import { CapMouseChoice } from '../carve/devices/cap_mouse';
import type { CapMouseHost } from '../carve/devices/cap_mouse';
import type { Participants } from '../model/participants';
import { Details, Figure, Section } from '../ui/figures';
import { count, figure, volume } from '../ui/format';
import { LanguageChoice } from '../ui/language_choice';
import { MaterialChoice } from '../ui/material_choice';
import { PanelFrame } from '../ui/panel_frame';
import type { Picture } from '../ui/picture';
import { duration } from '../ui/programs/texts';
import type { TextState } from '../ui/programs/text_state';
import { TextView } from '../ui/programs/text_view';
import { ProgressBar } from '../ui/progress_bar';
import type { Shell } from '../ui/shell';
import { TransportView } from '../ui/timeline/transport';
import type { Transport } from '../ui/timeline/transport';
import { ToolRack, ToolRackView } from '../ui/tools/tool_rack';
import type { ToolInfo } from '../wire/types';
import { EXAMPLE_TOOLS } from './example';
import type { ShownPath } from './local_path';
import type { About, GivenFiles, Progress, TakeHomeFormat } from './program_block';
import type { LocalState } from './state';

/** Whether the build has made the page also as one file (vite.single.config.ts). */
declare const KERF_HAS_SINGLE: boolean;

/** The files that can be removed one by one. */
export type FileKind = 'program' | 'scene' | 'stock' | 'journal';

export interface SideActions {
  choose: () => void;
  /** Carves a program that comes with the page. */
  example: () => void;
  /** Opens an uncarved block with these tools. */
  newBlock: (tools: readonly ToolInfo[]) => void;
  remove: (kind: FileKind) => void;
  /** Stops the worker. */
  stop: () => void;
  seek: (motion: number) => void;
  takeHome: (format: TakeHomeFormat) => void;
  save: () => void;
  linePressed: (line: number) => void;
}

export interface SidePanelProps {
  shell: Shell;
  state: LocalState;
  text: TextState;
  transport: Transport;
  path: ReadonlySignal<ShownPath | null>;
  participants: Participants;
  picture: Picture;
  /** The camera that a 3D mouse moves. */
  capMouse: CapMouseHost;
  actions: SideActions;
}

const KINDS: readonly [FileKind, string][] = [
  ['journal', t('KERF file')],
  ['program', t('program')],
  ['scene', t('scene')],
  ['stock', t('stock')],
];

/** The tools of the next block. */
function NewBlockTools({ newBlock }: Pick<SideActions, 'newBlock'>) {
  const rack = useMemo(() => new ToolRack(EXAMPLE_TOOLS), []);
  return (
    <details class="start-tools">
      <summary>{t('Tools for carving by hand')}</summary>
      <ToolRackView rack={rack} />
      <button type="button" class="history-button" onClick={() => newBlock(rack.tools)}>
        {t('New block with these tools')}
      </button>
    </details>
  );
}

interface FileListProps {
  files: GivenFiles;
  remove: (kind: FileKind) => void;
}

function FileList({ files, remove }: FileListProps) {
  return (
    <ul class="given-files">
      {KINDS.map(([kind, label]) => {
        const file = files[kind];
        return (
          file && (
            <li key={kind}>
              <span>{file.name}</span>
              <small class="quiet">{label}</small>
              <button
                type="button"
                class="quiet-action"
                aria-label={t('Remove {0}', file.name)}
                onClick={() => remove(kind)}
              >
                {t('Remove')}
              </button>
            </li>
          )
        );
      })}
      {files.others.map(({ name }) => (
        <li key={name}>
          <span>{name}</span>
          <small class="quiet">{t('subroutine')}</small>
        </li>
      ))}
    </ul>
  );
}

/** “Step 3 of 9, line 12, 0:03 / 0:09” */
function placeText(about: About, { carved, line, machining_s }: Progress): string {
  const where = t('Step {0} of {1}', count(carved), count(about.motions));
  const time = `${duration(machining_s)} / ${duration(about.machining_s)}`;
  return line > 0 ? t('{0}, line {1}, {2}', where, count(line), time) : where;
}

function shareOf(carved: number, motions: number): number {
  return motions > 0 ? carved / motions : 1;
}

/** How far the program or the journal is, and the controls that move it. */
function Program({ state, text, transport, path, actions }: SidePanelProps) {
  const { value: about } = state.about;
  const { value: progress } = state.progress;
  const { value: shownPath } = path;
  const isBusy = state.isBusy.value;
  const { value: status } = state.status;
  const isReading = status === 'reading';
  const isProgram = state.text.value !== null && !state.hasJournal.value;
  const motions = about?.motions ?? 0;
  const carved = progress?.carved ?? 0;
  const place = about && progress && status !== 'failed' ? placeText(about, progress) : '';
  const hasSteps =
    state.text.value !== null || state.files.value.journal !== null || state.hasJournal.value;
  return (
    <Section title={isProgram ? t('Program') : t('History')} hidden={!hasSteps}>
      <div class="program-one">
        <ProgressBar share={isReading ? null : shareOf(carved, motions)} hidden={!isBusy} />
      </div>
      <div class="scrub-row">
        <input
          type="range"
          min="0"
          step="1"
          class="scrub"
          aria-label={t('Position in the program')}
          aria-valuetext={place}
          max={motions}
          disabled={about === null}
          value={state.wish.value ?? carved}
          onInput={({ currentTarget }) => actions.seek(Number(currentTarget.value))}
        />
        <button type="button" class="history-button" hidden={!isBusy} onClick={actions.stop}>
          {t('Stop')}
        </button>
      </div>
      <TransportView transport={transport} />
      <p class="quiet program-figures">{isReading ? t('Reading…') : place}</p>
      {shownPath && <shownPath.Row path={shownPath.control} />}
      <TextView
        state={text}
        hidden={state.text.value === null}
        pressed={(line) => actions.linePressed(line)}
      />
    </Section>
  );
}

function Notes({ about }: { about: About | null }) {
  const lines = [...(about?.notes ?? []), ...(about?.warnings ?? [])];
  return (
    <Section title={t('Notes')} hidden={lines.length === 0}>
      <ul class="given-notes quiet">
        {lines.map((line, n) => (
          <li key={n}>{line}</li>
        ))}
      </ul>
    </Section>
  );
}

function BlockDetails({ state }: { state: LocalState }) {
  const { value: about } = state.about;
  const { value: hash } = state.hash;
  // A journal counts records: motions, undo and others.
  const isJournal = about?.kernel_version !== undefined;
  return (
    <Details>
      <dl class="figures">
        <Figure
          label={isJournal ? t('Steps') : t('Motions')}
          value={about ? count(about.motions) : '–'}
        />
        <Figure
          label={t('Triangles')}
          value={state.progress.value ? count(state.triangles.value) : '–'}
        />
        <Figure
          label={t('Grid spacing')}
          value={about ? figure(about.pitch_mm) : '–'}
          unit={about ? 'mm' : ''}
        />
      </dl>
      <p class="quiet hash">
        {t('State hash ')}
        <code
          class={hash === null ? '' : 'settled'}
          title={t('State hash: kerf-carve prints the same one for the same files')}
          data-settled={t('complete')}
        >
          {hash ?? '–'}
        </code>
      </p>
      <p class="quiet program-figures">
        {hash !== null &&
          t('Carved in {0} s in this browser.', figure(state.carvingMs.value / 1000))}
      </p>
    </Details>
  );
}

function FilesSection({ state, actions }: Pick<SidePanelProps, 'state' | 'actions'>) {
  return (
    <Section title={t('Files')}>
      {state.isStarter.value ? (
        <p class="quiet">
          {t('Drop an NC program, a model or a KERF file here. Nothing is uploaded.')}
        </p>
      ) : (
        <FileList files={state.files.value} remove={actions.remove} />
      )}
      <div class="history-actions files-actions">
        <button type="button" class="history-button" onClick={actions.choose}>
          {t('Choose files…')}
        </button>
        <button type="button" class="history-button" onClick={actions.example}>
          {t('Try an example')}
        </button>
        <button
          type="button"
          class="history-button"
          onClick={() => actions.newBlock(EXAMPLE_TOOLS)}
        >
          {t('New block')}
        </button>
      </div>
      <NewBlockTools newBlock={actions.newBlock} />
      <p class="program-note bad" role="alert">
        {state.error.value}
      </p>
    </Section>
  );
}

export function SidePanel(props: SidePanelProps) {
  const { shell, state, participants, picture, capMouse, actions } = props;
  const { value: progress } = state.progress;
  const [removed, unit] = progress ? volume(progress.removed_mm3) : ['–', ''];
  return (
    <PanelFrame shell={shell} label={t('Details')}>
      <FilesSection state={state} actions={actions} />
      <Program {...props} />
      <dl class="figures">
        <Figure label={t('Removed')} value={removed} unit={unit} />
      </dl>
      <Notes about={state.about.value} />
      <Section title={t('Material')}>
        <MaterialChoice picture={picture} participants={participants} />
      </Section>
      <p class="quiet program-figures" role="status">
        {state.stored.value}
      </p>
      <BlockDetails state={state} />
      <div class="preferences">
        <LanguageChoice />
        <CapMouseChoice host={capMouse} />
        {KERF_HAS_SINGLE && (
          <a class="quiet-action" href="./kerf-single.html" download="kerf.html">
            {t('Save this page as one file')}
          </a>
        )}
      </div>
    </PanelFrame>
  );
}
