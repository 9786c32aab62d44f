// SPDX-License-Identifier: Apache-2.0
// Choosing or dropping an NC or APT file, and how it is to be run.

import { t } from '../../strings';
import { PROGRAM_ENDINGS } from '../../model/programs';
import { h } from '../dom';
import type { TargetChoice } from './target_choice';

export interface UploadActions {
  /** `query`: pace, dialect, queue and target, as in server/http/README.md. */
  chosen: (file: File, query: string) => void;
}

/** Names of the server, and of the controls. */
const DIALECTS: [string, string][] = [
  ['linuxcnc', 'LinuxCNC'],
  ['grbl', 'grbl'],
  ['mach3', 'Mach3'],
  ['fanuc', 'Fanuc'],
  ['haas', 'Haas'],
  ['heidenhain', 'HEIDENHAIN'],
  ['siemens', 'SINUMERIK'],
];

export class Upload {
  private readonly file_ = h('input', {
    type: 'file',
    accept: PROGRAM_ENDINGS.join(','),
    class: 'program-file',
    'aria-label': t('NC or APT program'),
  });
  private readonly pace_ = h(
    'select',
    { class: 'program-speed', 'aria-label': t('Run speed') },
    h('option', { value: 'pace=fast' }, t('at full speed')),
    h('option', { value: 'pace=feed' }, t('at feed rate')),
  );
  private readonly dialect_ = h(
    'select',
    { class: 'program-speed', 'aria-label': t('CNC control of the program') },
    h('option', { value: '' }, t('detect the CNC control')),
    ...DIALECTS.map(([name, label]) => h('option', { value: name }, label)),
  );
  private readonly queue_ = h('input', { type: 'checkbox' });
  readonly element = h(
    'div',
    { class: 'program-upload' },
    h('p', {}, t('Drop an NC or APT file here, or choose one.')),
    this.file_,
    h(
      'p',
      { class: 'program-options' },
      this.pace_,
      this.dialect_,
      h('label', {}, this.queue_, t(' after the other programs')),
    ),
  );

  /** `area`: where files may be dropped. */
  constructor(
    area: HTMLElement,
    private readonly target: TargetChoice,
    private readonly actions: UploadActions,
  ) {
    this.element.append(target.element);
    this.queue_.checked = true;
    this.file_.addEventListener('change', () => {
      this.send_(this.file_.files);
      this.file_.value = ''; // the same file may be chosen again
    });
    area.addEventListener('dragover', (event) => {
      if (this.element.hidden || !event.dataTransfer?.types.includes('Files')) return;
      event.preventDefault();
      area.classList.add('dropping');
    });
    for (const end of ['dragleave', 'drop'])
      area.addEventListener(end, () => area.classList.remove('dropping'));
    area.addEventListener('drop', (event) => {
      if (this.element.hidden) return;
      event.preventDefault();
      this.send_(event.dataTransfer?.files ?? null);
    });
  }

  private send_(files: FileList | null): void {
    const dialect = this.dialect_.value === '' ? '' : `&dialect=${this.dialect_.value}`;
    const query = `${this.pace_.value}${dialect}&queue=${this.queue_.checked ? 1 : 0}${this.target.query}`;
    for (const file of files ?? []) this.actions.chosen(file, query);
  }
}
