// SPDX-License-Identifier: Apache-2.0
// The form of a new block: from a template, a model or a program; name, accuracy with its price.

import { t } from '../../strings';
import { templateText } from '../../strings/names';
import { closeSession, createSession } from '../../link/lobby_requests';
import type { Template } from '../../link/lobby_requests';
import { ServerError } from '../../link/server_error';
import { adapted, freeId, TARGET_DEFAULT_MM } from '../../model/new_block';
import { PROGRAM_ENDINGS } from '../../model/programs';
import { h, setText } from '../dom';
import { sentence } from '../format';
import { ICONS } from '../icons';
import { ProgramRequests } from '../programs/requests';
import { Accuracy } from './accuracy';
import { fromFile, fromTemplate, MESH_ENDINGS } from './drafts';
import type { Draft } from './drafts';
import { sessionUrl } from './session_url';

const NAME_CHARACTERS_MAX = 80;
const LINE_CHARACTERS_MAX = 200;

export class NewBlock {
  private readonly choices_ = h('div', {
    class: 'choices',
    role: 'group',
    'aria-label': t('Start from'),
  });
  private readonly note_ = h('p', { class: 'quiet', role: 'status' });
  private readonly fault_ = h('div', { class: 'fault', role: 'alert', hidden: '' });
  private readonly name_ = h('input', {
    class: 'text-input',
    maxlength: String(NAME_CHARACTERS_MAX),
  });
  private readonly create_ = h('button', { type: 'submit', class: 'button' }, t('Create'));
  private readonly accuracy_ = new Accuracy({
    changed: () => this.changed_(),
    priced: (possible) => (this.create_.disabled = !possible || this.busy_),
  });
  private readonly own_ = h('div', { class: 'draft' });
  private readonly form_ = h('form', { class: 'new-block-form', hidden: '' });
  readonly element: HTMLElement;
  private draft_: Draft | null = null;
  private busy_ = false;
  private reading_ = 0;
  private isForbidden_ = false;

  /** @param taken the ids of the sessions that exist */
  constructor(
    templates: readonly Template[],
    private readonly taken: () => string[],
  ) {
    this.choices_.append(...templates.map((template) => this.choice_(template)));
    this.form_.append(
      h('label', { class: 'field' }, h('span', { class: 'field-name' }, t('Name')), this.name_),
      this.own_,
      this.accuracy_.element,
      this.create_,
    );
    this.form_.addEventListener('submit', (event) => {
      event.preventDefault();
      void this.make_();
    });
    this.name_.addEventListener('input', () => this.changed_());
    this.element = h(
      'section',
      { class: 'new-block', 'aria-label': t('New block') },
      h('h2', {}, t('New block')),
      h(
        'div',
        { class: 'drops' },
        this.drop_(t('Run an NC program'), t('Drop or choose G-code or APT'), PROGRAM_ENDINGS),
        this.drop_(t('Carve a model'), t('Drop or choose STL, 3MF, GLB, PLY or OBJ'), MESH_ENDINGS),
      ),
      h('p', { class: 'quiet' }, t('or start from')),
      this.choices_,
      this.note_,
      this.fault_,
      this.form_,
    );
    this.acceptDrops_();
  }

  /** Shows everything disabled, with the reason. */
  forbid(reason: string): void {
    this.isForbidden_ = true;
    for (const control of this.element.querySelectorAll<HTMLInputElement>('button, input')) {
      control.disabled = true;
    }
    this.element.classList.add('forbidden');
    this.tell_(reason);
  }

  private choice_(template: Template): HTMLElement {
    const button = h(
      'button',
      { type: 'button', class: 'choice', 'aria-pressed': 'false' },
      h('b', {}, templateText(template.title)),
      h('small', {}, templateText(template.description)),
    );
    button.addEventListener('click', () => {
      this.press_(button);
      this.show_(fromTemplate(template, () => this.changed_()));
    });
    return button;
  }

  private press_(pressed: HTMLElement | null): void {
    for (const button of this.choices_.children)
      button.setAttribute('aria-pressed', String(button === pressed));
  }

  private drop_(title: string, text: string, endings: readonly string[]): HTMLElement {
    const input = h('input', {
      type: 'file',
      class: 'drop-input',
      accept: endings.join(','),
      'aria-label': title,
    });
    input.addEventListener('change', () => {
      const file = input.files?.[0];
      if (file) void this.read_(file);
      input.value = ''; // the same file may be chosen again
    });
    const label = h('label', { class: 'drop' }, input, h('b', {}, title), h('small', {}, text));
    label.insertAdjacentHTML('afterbegin', ICONS.upload);
    return label;
  }

  private acceptDrops_(): void {
    const area = document.body;
    area.addEventListener('dragover', (event) => {
      if (this.isForbidden_ || !event.dataTransfer?.types.includes('Files')) return;
      event.preventDefault();
      this.element.classList.add('dropping');
    });
    for (const end of ['dragleave', 'drop'])
      area.addEventListener(end, () => this.element.classList.remove('dropping'));
    area.addEventListener('drop', (event) => {
      if (this.isForbidden_) return;
      event.preventDefault();
      const file = event.dataTransfer?.files[0];
      if (file) void this.read_(file);
    });
  }

  private async read_(file: File, repair = false): Promise<void> {
    this.press_(null);
    this.form_.hidden = true;
    this.tell_('');
    setText(this.note_, t('Reading {0}…', file.name));
    const reading = ++this.reading_;
    try {
      const draft = await fromFile(file, () => this.changed_(), repair);
      if (reading === this.reading_) this.show_(draft);
    } catch (problem) {
      if (reading !== this.reading_) return;
      setText(this.note_, '');
      await this.tellFault_(file, problem as Error);
    }
  }

  private show_(draft: Draft): void {
    this.reading_ += 1; // a file that is still being read no longer counts
    this.draft_ = draft;
    setText(this.note_, '');
    this.tell_('');
    this.name_.value = draft.name;
    this.own_.replaceChildren(draft.element);
    this.accuracy_.targetMm = draft.targetMm ?? TARGET_DEFAULT_MM;
    setText(this.create_, draft.program ? t('Create and run') : t('Create'));
    this.form_.hidden = false;
    this.changed_();
    this.form_.scrollIntoView({ block: 'nearest' });
  }

  private changed_(): void {
    const { draft_: draft } = this;
    if (draft) void this.accuracy_.show(this.sceneOf_(draft), draft.priced);
  }

  private nameOf_(draft: Draft): string {
    return this.name_.value.trim() || draft.name;
  }

  private sceneOf_(draft: Draft): Record<string, unknown> {
    return adapted(draft.scene(), this.nameOf_(draft), this.accuracy_.targetMm);
  }

  private async make_(): Promise<void> {
    const draft = this.draft_;
    if (!draft || this.busy_) return;
    this.setBusy_(true);
    this.tell_('');
    try {
      const id = freeId(this.nameOf_(draft), this.taken());
      await createSession(id, this.sceneOf_(draft));
      if (draft.program) await this.run_(id, draft.program);
      location.assign(sessionUrl(id) + (draft.program ? '&play' : ''));
    } catch (problem) {
      this.setBusy_(false);
      if (draft.program) await this.tellFault_(draft.program, problem as Error);
      else this.tell_(sentence((problem as Error).message));
    }
  }

  private setBusy_(busy: boolean): void {
    this.busy_ = busy;
    this.create_.disabled = busy;
  }

  /** Starts the program; a session that cannot run it is not kept. */
  private async run_(id: string, program: File): Promise<void> {
    try {
      await new ProgramRequests(id).upload(program, 'pace=fast');
    } catch (problem) {
      await closeSession(id, true).catch(() => undefined);
      throw problem;
    }
  }

  private repairButton_(file: File): HTMLElement {
    const button = h('button', { type: 'button', class: 'button' }, t('Close holes'));
    button.addEventListener('click', () => void this.read_(file, true));
    return button;
  }

  /** Shows a file's error with its line, and offers to repair a model. */
  private async tellFault_(file: File, problem: Error): Promise<void> {
    this.tell_(sentence(problem.message));
    if (!(problem instanceof ServerError)) return;
    if (problem.code === 'not_closed') this.fault_.append(this.repairButton_(file));
    if (problem.line === 0) return;
    const line = (await file.text()).split('\n')[problem.line - 1]?.trim() ?? '';
    this.fault_.append(h('code', {}, `${problem.line}: ${line.slice(0, LINE_CHARACTERS_MAX)}`));
  }

  private tell_(text: string): void {
    this.fault_.replaceChildren(...(text === '' ? [] : [h('p', {}, text)]));
    this.fault_.hidden = text === '';
  }
}
