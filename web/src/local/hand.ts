// SPDX-License-Identifier: Apache-2.0
// Carving by hand in the page without a server: the button, who carves, and the file of it.

import { t } from '../strings';
import type { CarveLinkEvents } from '../carve/carve_link';
import { CarvePart } from '../carve/part';
import type { CarveHost } from '../carve/host';
import type { SessionModel } from '../model/session';
import type { NewTool } from '../model/tool_sizes';
import type { ButtonAction } from '../ui/actions';
import type { ParticipantInfo, ToolInfo } from '../wire/types';
import { recall } from '../strings/memory';
import { forgetStrokes, keepStrokes } from './autosave';
import { download } from './download';
import { HandLink } from './hand_link';
import type { FromWorker, ToWorker } from './messages';
import { translated } from './reasons';
import type { JournalParts } from './program_block';
import { newWriter } from './record_origins';

/** Between two times at which strokes are kept in the browser. */
const KEEP_EVERY_MS = 3000;
/** Of the motions of a program, in the journal that goes on from it (web/wasm/files). */
const PROGRAM = 1;

export interface HandHost extends Omit<
  CarveHost,
  'session' | 'name' | 'linkHere' | 'makeToolHere'
> {
  post(message: ToWorker): void;
  /** Why nothing can be carved by hand now; empty: it can. */
  whyNot(): string;
  /** The .kerf file from which the block comes; null: none. */
  file(): Uint8Array | null;
}

export class LocalHand {
  readonly carve: CarvePart;
  /** The action that begins and ends carving. */
  readonly action: ButtonAction;
  private link_: HandLink | null = null;
  private people_: readonly ParticipantInfo[] = [];
  private own_: ParticipantInfo | null = null; // once it has carved this block
  /** Of the records that the page adds to the block. */
  private writer_ = newWriter();
  private isSaved_ = true;
  /** Whether the block has strokes that only the browser has kept. */
  private isRestored_ = false;
  private timer_: ReturnType<typeof setTimeout> | undefined;
  private keepTimer_: ReturnType<typeof setTimeout> | undefined;
  /** Handlers of the worker's answers, in the order of the requests. */
  private asked_: ('file' | 'autosave')[] = [];
  /** The tool that the worker makes: one after the other. */
  private making_: {
    resolve: (tool: ToolInfo) => void;
    reject: (reason: Error) => void;
  } | null = null;

  constructor(private readonly host: HandHost) {
    this.carve = new CarvePart({
      ...host,
      session: '',
      name: () => this.name_(),
      linkHere: (events) => this.makeLink_(events),
      makeToolHere: (tool) => this.makeTool_(tool),
    });
    this.action = { ...this.carve.action, perform: () => this.toggle() };
    window.addEventListener('beforeunload', (event) => {
      if (!this.isSaved_) event.preventDefault(); // the browser asks
    });
  }

  get isActive(): boolean {
    return this.carve.isActive;
  }

  /** Whether the block does not have everything yet that the hand has done. */
  get isBusy(): boolean {
    return this.carve.isBusy;
  }

  /** Whether a tool is in the hand, in the page or in a headset. */
  get hasTool(): boolean {
    return this.isActive || this.carve.vrState !== null;
  }

  /** Whether another block may take the place of this one: strokes that are in no file would go. */
  mayGo(): boolean {
    const question = t('Unsaved strokes: discard them?');
    if (this.isSaved_ && !this.isRestored_) return true;
    const goes = window.confirm(question);
    if (goes) this.forget_();
    return goes;
  }

  toggle(): void {
    if (this.isActive || this.host.whyNot() === '') this.carve.toggle();
    else this.host.say(this.host.whyNot());
  }

  leave(): void {
    if (this.isActive) this.carve.toggle();
  }

  /** Another block takes the place of the one before; `people`: who has carved it, a program too. */
  reset(people: readonly ParticipantInfo[]): void {
    this.leave();
    this.link_?.drop();
    this.people_ = people;
    this.own_ = null;
    this.writer_ = newWriter();
    this.isSaved_ = true;
    this.isRestored_ = false;
    clearTimeout(this.keepTimer_);
    this.keepTimer_ = undefined;
    this.asked_ = [];
  }

  /** The block is made of the strokes that the browser has kept. */
  restored(): void {
    this.isRestored_ = true;
  }

  /** Writes the file. */
  save(): void {
    this.ask_('file');
  }

  heard(message: FromWorker): void {
    if (message.type === 'handed' && this.link_) this.takeOver_(this.link_, this.host.model);
    if (message.type === 'felt' || message.type === 'changed') {
      this.isSaved_ = false;
      this.keepTimer_ ??= setTimeout(() => this.keep_(), KEEP_EVERY_MS);
    }
    if (message.type === 'tool') {
      const tool = message.tools.find(({ id }) => id === message.id);
      if (tool) this.making_?.resolve(tool);
      else this.making_?.reject(new Error(translated(message.reason)));
    }
    if (message.type === 'saved') void this.write_(message.parts, this.asked_.shift()!);
    this.link_?.heard(message);
  }

  /** Those of the list of participants who have carved the block. */
  private takeOver_({ participant }: HandLink, model: SessionModel): void {
    const { color } = model.welcome!;
    const name = this.name_();
    this.own_ = { participant: participant!, name, color, tool: 0, kind: 'agent' };
    model.participants.setList([...this.others_(), this.own_]);
  }

  private others_(): ParticipantInfo[] {
    return this.people_.filter(({ participant }) => participant !== this.own_?.participant);
  }

  private name_(): string {
    const name = recall('name') ?? '';
    return name === '' ? t('You') : name;
  }

  private makeLink_(events: CarveLinkEvents): HandLink {
    this.link_ = new HandLink(
      {
        post: (message) => this.host.post(message),
        participant: () =>
          this.own_?.participant ??
          1 + Math.max(PROGRAM, ...this.people_.map(({ participant }) => participant)),
        wallMs: () => Date.now(),
        later: (act, ms) => {
          clearTimeout(this.timer_);
          this.timer_ = setTimeout(act, ms);
        },
      },
      events,
    );
    return this.link_;
  }

  private makeTool_(tool: NewTool): Promise<ToolInfo> {
    this.host.post({ type: 'tool', tool: JSON.stringify(tool), wallMs: Date.now() });
    return new Promise((resolve, reject) => (this.making_ = { resolve, reject }));
  }

  private ask_(what: 'file' | 'autosave'): void {
    this.asked_.push(what);
    this.host.post({ type: 'save' });
  }

  private keep_(): void {
    this.keepTimer_ = undefined;
    if (!this.isSaved_) this.ask_('autosave');
  }

  private forget_(): void {
    forgetStrokes().catch((problem: unknown) => console.warn(problem));
  }

  private async write_(parts: JournalParts, what: 'file' | 'autosave'): Promise<void> {
    try {
      const { writeKerfFile } = await import('./kerf_file_writer');
      const own = this.own_ ? [{ ...this.own_, name: this.name_() }] : [];
      const people = [...this.others_(), ...own];
      const bytes = await writeKerfFile(parts, people, this.host.file(), this.writer_);
      const name = `${new TextDecoder().decode(parts.id)}.kerf`;
      if (what === 'autosave') {
        await keepStrokes({ name, bytes, atMs: Date.now() });
        return;
      }
      download(name, bytes);
      this.isSaved_ = true;
      this.isRestored_ = false;
      this.forget_();
    } catch (problem) {
      const reason = (problem as Error).message;
      if (what === 'file') this.host.say(t('The file could not be saved: {0}', reason));
      else console.warn(`The strokes are not kept in the browser: ${reason}`);
    }
  }
}
