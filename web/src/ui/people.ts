// SPDX-License-Identifier: Apache-2.0
// The list of participants: color, name, tool, current force; below it those who watch. Pressing a
// name follows that tool and plots its forces.

import { t } from '../strings';
import { roleName } from '../strings/names';
import { toolName } from '../model/tool_profile';
import type { Participant } from '../model/participants';
import type { SessionModel } from '../model/session';
import { STATUS_COLLIDING, STATUS_CUTTING } from '../wire/types';
import type { ParticipantInfo } from '../wire/types';
import { h, setText } from './dom';
import { feltBeside } from './format';
import { Watchers } from './watchers';

interface Row {
  element: HTMLElement;
  button: HTMLButtonElement;
  name: HTMLElement;
  about: HTMLElement;
  force: HTMLElement;
  state: HTMLElement;
}

/** What a participant's tool does. */
const STATES = {
  muted: t('muted'),
  idle: t('idle'),
  colliding: t('colliding'),
  cutting: t('cutting'),
  air: t('in the air'),
};

/** What stands before the tool of a participant. */
function marksOf({ kind, role }: ParticipantInfo): string[] {
  if (kind === 'program') return [t('program')];
  return role === undefined ? [] : [roleName(role)];
}

export class People {
  readonly element = h('ul', { class: 'people' });
  private readonly watchers_: Watchers;
  readonly root: HTMLElement;
  private readonly rows_ = new Map<number, Row>();
  private revision_ = -1;

  constructor(
    private readonly model: SessionModel,
    private readonly pressed: (participant: number) => void,
    renamed: (name: string) => void,
  ) {
    this.watchers_ = new Watchers(model, renamed);
    this.root = h('div', {}, this.element, this.watchers_.element);
  }

  update(selected: number | null, followed: number | null, nowMs: number): void {
    if (this.revision_ !== this.model.participants.revision) this.rebuild_();
    for (const participant of this.model.participants.carvers()) {
      const row = this.rows_.get(participant.info.participant);
      if (row) this.updateRow_(row, participant, selected, followed, nowMs);
    }
  }

  private rebuild_(): void {
    this.revision_ = this.model.participants.revision;
    this.rows_.clear();
    const carvers = this.model.participants.carvers();
    this.element.replaceChildren(...carvers.map((participant) => this.row_(participant).element));
    if (carvers.length === 0) {
      this.element.append(h('li', { class: 'quiet' }, t('Nobody is carving.')));
    }
    this.watchers_.update();
  }

  private row_(participant: Participant): Row {
    const { participant: id, color } = participant.info;
    const called = h('span');
    const about = h('small');
    const force = h('span', { class: 'person-force' });
    const state = h('span', { class: 'person-state' });
    const button = h(
      'button',
      { type: 'button', class: 'person', style: `--who:${color}`, title: t('Follow this tool') },
      h('span', { class: 'person-dot' }),
      h('span', { class: 'person-name' }, called, about),
      state,
      force,
    );
    button.addEventListener('click', () => this.pressed(id));
    const row = { element: h('li', {}, button), button, name: called, about, force, state };
    this.rows_.set(id, row);
    return row;
  }

  private updateRow_(
    row: Row,
    participant: Participant,
    selected: number | null,
    followed: number | null,
    nowMs: number,
  ): void {
    const id = participant.info.participant;
    row.button.classList.toggle('selected', id === selected);
    row.button.setAttribute('aria-pressed', String(id === followed));
    const { name } = participant.info;
    const isSelf = this.model.participants.isAgentOf(this.model.welcome?.participant, participant);
    setText(row.name, isSelf ? t('{0} (you)', name) : name);
    // The tool comes with every frame, and the list of participants only when it changes.
    const tool = toolName(this.model.tool(participant.tool || (participant.info.tool ?? 0)));
    setText(row.about, [...marksOf(participant.info), tool].join(' · '));
    const fresh = nowMs - participant.seenMs < 1500;
    const { status } = participant;
    setText(
      row.force,
      fresh ? feltBeside(participant.forces.latest.forceN, participant.feltShare, 'N') : '',
    );
    const state = participant.info.muted
      ? 'muted'
      : !fresh
        ? 'idle'
        : status & STATUS_COLLIDING
          ? 'colliding'
          : status & STATUS_CUTTING
            ? 'cutting'
            : 'air';
    const word = STATES[state];
    setText(row.state, id === followed ? t('{0} · following', word) : word);
    row.state.dataset['state'] = state;
  }
}
