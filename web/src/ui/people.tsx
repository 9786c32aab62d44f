// SPDX-License-Identifier: Apache-2.0
// The list of participants: color, name, tool, current force. Below it are the viewers who watch.
// Pressing a name follows that tool and plots its forces.

import type { ReadonlySignal } from '@preact/signals';
import { t } from '../strings';
import { roleName } from '../strings/names';
import { toolName } from '../model/tool_profile';
import type { Participant } from '../model/participants';
import type { SessionModel } from '../model/session';
import { STATUS_COLLIDING, STATUS_CUTTING } from '../wire/types';
import type { ParticipantInfo } from '../wire/types';
import { feltBeside } from './format';
import type { PersonChoice } from './person_choice';
import { Watchers } from './watchers';
import type { WatchersProps } from './watchers';

/** Without a tool state for so long, a participant is idle. */
const SILENT_MS = 1500;

/** States of a participant's tool. */
const STATES = {
  muted: t('muted'),
  idle: t('idle'),
  colliding: t('colliding'),
  cutting: t('cutting'),
  air: t('in the air'),
};

function stateOf({ info, status }: Participant, isFresh: boolean): keyof typeof STATES {
  if (info.muted) return 'muted';
  if (!isFresh) return 'idle';
  if (status & STATUS_COLLIDING) return 'colliding';
  return status & STATUS_CUTTING ? 'cutting' : 'air';
}

/** Returns the words before the tool of a participant. */
function marksOf({ kind, role }: ParticipantInfo): string[] {
  if (kind === 'program') return [t('program')];
  return role === undefined ? [] : [roleName(role)];
}

export interface PeopleProps extends WatchersProps {
  model: SessionModel;
  choice: Pick<PersonChoice, 'selected' | 'followed' | 'press'>;
  /** Local time, ms, at which forces and states of tools are sampled. */
  nowMs: ReadonlySignal<number>;
}

function Person({ model, choice, nowMs, participant }: PeopleProps & { participant: Participant }) {
  const { info, forces, feltShare, seenMs } = participant;
  const isFresh = nowMs.value - seenMs < SILENT_MS;
  const isFollowed = choice.followed === info.participant;
  const isSelf = model.participants.isAgentOf(model.welcome?.participant, participant);
  // The tool comes with every frame, and the list of participants only when it changes.
  const tool = toolName(model.tool(participant.tool || (info.tool ?? 0)));
  const state = stateOf(participant, isFresh);
  const word = STATES[state];
  return (
    <li>
      <button
        type="button"
        class={info.participant === choice.selected ? 'person selected' : 'person'}
        style={`--who:${info.color}`}
        title={t('Follow this tool')}
        aria-pressed={isFollowed}
        onClick={() => choice.press(info.participant)}
      >
        <span class="person-dot" />
        <span class="person-name">
          <span>{isSelf ? t('{0} (you)', info.name) : info.name}</span>
          <small>{[...marksOf(info), tool].join(' · ')}</small>
        </span>
        <span class="person-state" data-state={state}>
          {isFollowed ? t('{0} · following', word) : word}
        </span>
        <span class="person-force">
          {isFresh ? feltBeside(forces.latest.forceN, feltShare, 'N') : ''}
        </span>
      </button>
    </li>
  );
}

/** The lists of the participants. */
export function People(props: PeopleProps) {
  const carvers = props.model.participants.carvers();
  return (
    <div>
      <ul class="people">
        {carvers.map((participant) => (
          <Person key={participant.info.participant} {...props} participant={participant} />
        ))}
        {carvers.length === 0 && <li class="quiet">{t('Nobody is carving.')}</li>}
      </ul>
      <Watchers {...props} />
    </div>
  );
}
