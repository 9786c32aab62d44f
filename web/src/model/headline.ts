// SPDX-License-Identifier: Apache-2.0
// Who does what to the block, and how far it is: one sentence for somebody who has just come.

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
  if (rest <= 0) return names.join(' and ');
  return `${names.slice(0, LISTED).join(', ')} and ${rest === 1 ? '1 other' : `${rest} others`}`;
}

function clock(seconds: number): string {
  const whole = Math.ceil(seconds);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, '0')}`;
}

/** How far the only running program is; with several, nothing says what the whole is. */
function farOf({ programs }: SessionModel): string {
  const running = programs.all().filter(({ state }) => state === 'running' || state === 'paused');
  const [program] = running;
  if (!program || running.length > 1) return '';
  const isTimed = program.pace === 'feed' && program.programmed_s > 0;
  const part = isTimed
    ? program.elapsed_s / program.programmed_s
    : program.motions_done / Math.max(1, program.motions);
  const percent = `${Math.floor(100 * Math.min(1, part))} %`;
  if (program.state === 'paused') return `${percent}, paused`;
  const left = wallSeconds(program);
  return Number.isFinite(left) ? `${percent}, ${clock(left)} left` : percent;
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
    const are = carvers.length === 1 ? 'is' : 'are';
    return { who: `${namesOf(carvers.map(nameOf))} ${are} here; no tool moves`, far };
  }
  const [first] = moving;
  const isOne = moving.length === 1 && first;
  const tool = isOne ? ` · ${toolName(model.tool(first.tool || (first.info.tool ?? 0)))}` : '';
  const verb = moving.length === 1 ? 'carves' : 'carve';
  return { who: `${namesOf(moving.map(nameOf))} ${verb} ${what}${tool}`, far };
}
