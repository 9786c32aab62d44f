// SPDX-License-Identifier: Apache-2.0
// Who does what to the block, and how far it is: one sentence for somebody who has just come.

import { t } from '../strings';
import type { Participant } from './participants';
import { wallSeconds } from './programs';
import type { SessionModel } from './session';
import { toolName } from './tool_profile';

/** A tool that has moved within so long is in use. */
const MOVING_MS = 5000;
const LISTED = 2;

export interface Headline {
  /** “Ada and Grace carve Ammonite”; empty: nobody is there. */
  who: string;
  /** “61 %, 1:20 left”; empty: not known. */
  far: string;
}

/** “Ada”, “Ada and Grace”, “Ada, Grace and 3 others”. */
export function namesOf(names: readonly string[]): string {
  const rest = names.length - LISTED;
  if (names.length <= 1) return names.join('');
  if (rest <= 0) return t('{0} and {1}', names[0]!, names[1]!);
  const listed = names.slice(0, LISTED).join(', ');
  return rest === 1 ? t('{0} and 1 other', listed) : t('{0} and {1} others', listed, rest);
}

function clock(seconds: number): string {
  const whole = Math.ceil(seconds);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, '0')}`;
}

/**
 * Progress of the only running program; empty without one, and for several, whose total is
 * undefined.
 */
function farOf({ programs }: SessionModel): string {
  const running = programs.all().filter(({ state }) => state === 'running' || state === 'paused');
  const [program] = running;
  if (!program || running.length > 1) return '';
  const isTimed = program.pace === 'feed' && program.programmed_s > 0;
  const part = isTimed
    ? program.elapsed_s / program.programmed_s
    : program.motions_done / Math.max(1, program.motions);
  const percent = `${Math.floor(100 * Math.min(1, part))} %`;
  if (program.state === 'paused') return t('{0}, paused', percent);
  const left = wallSeconds(program);
  return Number.isFinite(left) ? t('{0}, {1} left', percent, clock(left)) : percent;
}

/** @param nowMs by the clock of Participant.seenMs */
export function headlineOf(model: SessionModel, session: string, nowMs: number): Headline {
  const what = model.welcome?.name ?? session;
  const carvers = model.participants.carvers();
  const moving = carvers.filter(({ seenMs }) => nowMs - seenMs < MOVING_MS);
  const far = farOf(model);
  const nameOf = ({ info }: Participant): string => info.name;
  if (moving.length === 0) {
    if (carvers.length === 0) return { who: '', far };
    const names = namesOf(carvers.map(nameOf));
    const isAlone = carvers.length === 1;
    const who = isAlone
      ? t('{0} is here but not carving', names)
      : t('{0} are here but not carving', names);
    return { who, far };
  }
  const [first] = moving;
  const isOne = moving.length === 1 && first;
  const tool = isOne ? ` · ${toolName(model.tool(first.tool || (first.info.tool ?? 0)))}` : '';
  const names = namesOf(moving.map(nameOf));
  const who = isOne ? t('{0} carves {1}', names, what) : t('{0} carve {1}', names, what);
  return { who: who + tool, far };
}
