// SPDX-License-Identifier: Apache-2.0
// Choosing or dropping an NC or APT file, and how it is to be run.

import { signal } from '@preact/signals';
import { t } from '../../strings';
import { PROGRAM_ENDINGS } from '../../model/programs';
import { TargetRow } from './target_choice';
import type { TargetChoice } from './target_choice';

/** Names of the server, and of the controls. */
const DIALECTS: readonly [string, string][] = [
  ['linuxcnc', 'LinuxCNC'],
  ['grbl', 'grbl'],
  ['mach3', 'Mach3'],
  ['fanuc', 'Fanuc'],
  ['haas', 'Haas'],
  ['heidenhain', 'HEIDENHAIN'],
  ['siemens', 'SINUMERIK'],
];

/** How the next program is to be run. */
export class RunOptions {
  readonly pace = signal('fast');
  /** Empty: the server detects the control. */
  readonly dialect = signal('');
  readonly isQueued = signal(true);

  constructor(readonly target: TargetChoice) {}

  /** Pace, dialect, queue and target, as in server/http/README.md. */
  get query(): string {
    const dialect = this.dialect.value === '' ? '' : `&dialect=${this.dialect.value}`;
    const queue = `&queue=${this.isQueued.value ? 1 : 0}`;
    return `pace=${this.pace.value}${dialect}${queue}${this.target.query}`;
  }
}

interface UploadProps {
  options: RunOptions;
  hidden: boolean;
  send: (files: FileList | null) => void;
}

export function Upload({ options, hidden, send }: UploadProps) {
  return (
    <div class="program-upload" hidden={hidden}>
      <p>{t('Drop an NC or APT file here, or choose one.')}</p>
      <input
        type="file"
        accept={PROGRAM_ENDINGS.join(',')}
        class="program-file"
        aria-label={t('NC or APT program')}
        onChange={({ currentTarget }) => {
          send(currentTarget.files);
          currentTarget.value = ''; // the same file may be chosen again
        }}
      />
      <p class="program-options">
        <select
          class="program-speed"
          aria-label={t('Run speed')}
          value={options.pace.value}
          onChange={({ currentTarget }) => (options.pace.value = currentTarget.value)}
        >
          <option value="fast">{t('at full speed')}</option>
          <option value="feed">{t('at feed rate')}</option>
        </select>
        <select
          class="program-speed"
          aria-label={t('CNC control of the program')}
          value={options.dialect.value}
          onChange={({ currentTarget }) => (options.dialect.value = currentTarget.value)}
        >
          <option value="">{t('detect the CNC control')}</option>
          {DIALECTS.map(([name, label]) => (
            <option key={name} value={name}>
              {label}
            </option>
          ))}
        </select>
        <label>
          <input
            type="checkbox"
            checked={options.isQueued.value}
            onChange={({ currentTarget }) => (options.isQueued.value = currentTarget.checked)}
          />
          {t(' after the other programs')}
        </label>
      </p>
      <TargetRow choice={options.target} />
    </div>
  );
}
