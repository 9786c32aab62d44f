// SPDX-License-Identifier: Apache-2.0
// The list of this server's sessions, as it was requested last, and its management.

import { signal } from '@preact/signals';
import { t } from '../../strings';
import { listSessions } from '../../link/api';
import type { SessionSummary } from '../../link/api';
import {
  closeSession,
  duplicateSession,
  listTemplates,
  priceOf,
  renameSession,
} from '../../link/lobby_requests';
import type { Template } from '../../link/lobby_requests';
import type { ServerError } from '../../link/server_error';
import { freeName } from '../../model/new_block';
import { sentence } from '../format';
import type { Order } from './card_order';
import { NewBlock } from './new_block_state';

const UPDATE_MS = 3000;

export class LobbyState {
  readonly sessions;
  /** The form of a new block; null until its templates are known. */
  readonly newBlock = signal<NewBlock | null>(null);
  /** Whether this viewer may create sessions. */
  readonly mayManage = signal(false);
  /** The session that the user is asked about before it is closed; null: none. */
  readonly toClose = signal<SessionSummary | null>(null);
  /** The session for which the user is asked another name; null: none. */
  readonly toRename = signal<SessionSummary | null>(null);
  readonly fault = signal('');
  /** Part of the names that are shown, as the user has typed it. */
  readonly search = signal('');
  readonly order = signal<Order>('active');
  private pollFault_ = ''; // the fault if it is one of polling the list

  constructor(sessions: readonly SessionSummary[]) {
    this.sessions = signal(sessions);
  }

  start(): void {
    void this.addForm_();
    setInterval(() => void this.update(), UPDATE_MS);
    document.addEventListener('visibilitychange', () => void this.update());
  }

  /** Requests the list again, unless the page is hidden. */
  async update(): Promise<void> {
    if (document.hidden) return;
    try {
      this.sessions.value = await listSessions();
      if (this.fault.peek() === this.pollFault_) this.fault.value = ''; // no other fault
    } catch (problem) {
      this.pollFault_ = (problem as Error).message;
      this.fault.value = this.pollFault_;
    }
  }

  async close({ id }: SessionSummary): Promise<void> {
    try {
      await closeSession(id);
    } catch (problem) {
      this.tell_(problem);
      return;
    }
    await this.update();
  }

  /** Returns the reason if the session keeps its name, as a sentence; empty: it is renamed. */
  async rename({ id }: SessionSummary, name: string): Promise<string> {
    try {
      await renameSession(id, name);
    } catch (problem) {
      const { code, message } = problem as ServerError;
      return code === 'name_taken' ? t('Another block has this name.') : sentence(message);
    }
    await this.update();
    return '';
  }

  /** Makes a session with the same block, under a name of its own. */
  async duplicate({ id, name }: SessionSummary): Promise<void> {
    const taken = this.sessions.peek().map((one) => one.name);
    try {
      await duplicateSession(id, freeName(name, taken));
    } catch (problem) {
      this.tell_(problem);
      return;
    }
    await this.update();
  }

  private async addForm_(): Promise<void> {
    let templates: Template[];
    try {
      templates = await listTemplates();
    } catch (problem) {
      this.tell_(problem);
      return;
    }
    const block = new NewBlock(templates, () => this.sessions.peek());
    this.newBlock.value = block;
    block.whyNot.value = await this.whyNotCreate_(templates);
    this.mayManage.value = block.whyNot.peek() === '';
  }

  /** Why the viewer may not create sessions; empty: it may. */
  private async whyNotCreate_(templates: readonly Template[]): Promise<string> {
    try {
      await priceOf(templates[0]?.scene ?? {});
    } catch (problem) {
      const { status, message } = problem as ServerError;
      if (status === 401 || status === 403) return sentence(message);
    }
    return '';
  }

  private tell_(problem: unknown): void {
    this.fault.value = sentence((problem as Error).message);
  }
}
