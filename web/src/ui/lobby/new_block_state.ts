// SPDX-License-Identifier: Apache-2.0
// A new block that is being described: its source, name and accuracy, and its creation.

import { batch, effect, signal, untracked } from '@preact/signals';
import { t } from '../../strings';
import type { SessionSummary } from '../../link/api';
import { closeSession, createSession } from '../../link/lobby_requests';
import type { Template } from '../../link/lobby_requests';
import { ServerError } from '../../link/server_error';
import { adapted, freeId, freeName, TARGET_DEFAULT_MM } from '../../model/new_block';
import { sentence } from '../format';
import { ProgramRequests } from '../programs/requests';
import { Accuracy } from './accuracy';
import { fromFile, fromTemplate } from './drafts';
import type { Draft } from './drafts';
import { sessionUrl } from './session_url';

const LINE_CHARACTERS_MAX = 200;

/** Why there is no block. */
export interface Fault {
  text: string;
  /** The line of the file with the fault; empty: none is known. */
  line: string;
  /** The model whose holes can be closed; null: none. */
  repairable: File | null;
}

export class NewBlock {
  readonly draft = signal<Draft | null>(null);
  /** The template that was chosen; null: a file, or nothing. */
  readonly template = signal<Template | null>(null);
  readonly name = signal('');
  readonly accuracy = new Accuracy();
  /** Which file is being read; empty: none. */
  readonly note = signal('');
  readonly fault = signal<Fault | null>(null);
  /** The session is being created. */
  readonly isBusy = signal(false);
  /** Why this viewer may create no session; empty: it may. */
  readonly whyNot = signal('');
  private reading_ = 0;

  /** @param sessions returns those that exist */
  constructor(
    readonly templates: readonly Template[],
    private readonly sessions: () => readonly Pick<SessionSummary, 'id' | 'name'>[],
  ) {
    effect(() => {
      const draft = this.draft.value;
      if (!draft) return;
      const scene = this.sceneOf_(draft);
      untracked(() => void this.accuracy.show(scene, draft.priced));
    });
  }

  choose(template: Template): void {
    batch(() => {
      this.template.value = template;
      this.show_(fromTemplate(template));
    });
  }

  /** Creates a block of the first template, which is for carving by hand, as it is. */
  async createAtOnce(): Promise<void> {
    const [first] = this.templates;
    if (!first || this.isBusy.peek()) return;
    this.choose(first);
    await this.create();
  }

  async read(file: File, repair = false): Promise<void> {
    batch(() => {
      this.template.value = null;
      this.draft.value = null;
      this.fault.value = null;
      this.note.value = t('Reading {0}…', file.name);
    });
    const reading = ++this.reading_;
    try {
      const draft = await fromFile(file, repair);
      if (reading === this.reading_) this.show_(draft);
    } catch (problem) {
      if (reading !== this.reading_) return;
      this.note.value = '';
      await this.tellFault_(file, problem as Error);
    }
  }

  async create(): Promise<void> {
    const draft = this.draft.peek();
    if (!draft || this.isBusy.peek()) return;
    this.isBusy.value = true;
    this.fault.value = null;
    try {
      const id = freeId(
        this.nameOf_(draft),
        this.sessions().map((one) => one.id),
      );
      await createSession(id, this.sceneOf_(draft));
      if (draft.program) await this.run_(id, draft.program);
      location.assign(sessionUrl(id, draft.program ? 'play' : 'carve'));
    } catch (problem) {
      this.isBusy.value = false;
      if (draft.program) await this.tellFault_(draft.program, problem as Error);
      else this.tell_(sentence((problem as Error).message));
    }
  }

  private show_(draft: Draft): void {
    this.reading_ += 1; // a file that is still being read no longer counts
    batch(() => {
      this.note.value = '';
      this.fault.value = null;
      this.name.value = freeName(
        draft.name,
        this.sessions().map((one) => one.name),
      );
      this.accuracy.targetMm.value = draft.targetMm ?? TARGET_DEFAULT_MM;
      this.draft.value = draft;
    });
  }

  private nameOf_(draft: Draft): string {
    return this.name.value.trim() || draft.name;
  }

  private sceneOf_(draft: Draft): Record<string, unknown> {
    return adapted(draft.scene(), this.nameOf_(draft), this.accuracy.targetMm.value);
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

  /** Shows a file's error with its line, and offers to repair a model. */
  private async tellFault_(file: File, problem: Error): Promise<void> {
    const text = sentence(problem.message);
    if (!(problem instanceof ServerError)) {
      this.tell_(text);
      return;
    }
    const repairable = problem.code === 'not_closed' ? file : null;
    const { line } = problem;
    const content = line === 0 ? '' : ((await file.text()).split('\n')[line - 1]?.trim() ?? '');
    const shown = line === 0 ? '' : `${line}: ${content.slice(0, LINE_CHARACTERS_MAX)}`;
    this.fault.value = { text, line: shown, repairable };
  }

  private tell_(text: string): void {
    this.fault.value = { text, line: '', repairable: null };
  }
}
