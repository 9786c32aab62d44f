// SPDX-License-Identifier: Apache-2.0
// JSON control messages between an agent and the server: the messages that this page sends, and the
// fields of the answers that it uses. Unknown fields and types are skipped.

import { colorOf, flag, number, object, text } from './json_fields';
import type { Json } from './json_fields';
import type { Decoded } from './types';

export interface AgentHello {
  type: 'hello';
  name: string;
  color: string;
  tool: number;
  /** Results state the newest sample that is on the server's disk. */
  durable: true;
  /** Stock frames of the whole block, also those with the flag returned: for a copy of it. */
  stock?: true;
  whole?: true;
  returned?: true;
  /** The token of an earlier welcome: continues as the same participant. */
  resume?: string;
}

export type AgentRequest =
  | AgentHello
  | { type: 'tool'; tool: number }
  | { type: 'stock' }
  | { type: 'undo' }
  | { type: 'redo' };

export interface AgentWelcome {
  type: 'welcome';
  participant: number;
  epoch: number;
  color: string;
  /** Highest speed of the tip while it cuts, mm/s. */
  speedMmPerS: number;
  samplesPerMessage: number;
  samplesPerS: number;
  resume: {
    token: string;
    resumed: boolean;
    /** The newest sample that the server has of this participant; 0: none. */
    agentSequence: bigint;
  };
  /** Addresses of other servers that may go on with the session. */
  others: string[];
}

/** The outcome of an `undo` or `redo`; with a code nothing has changed. */
export interface StrokeAnswer {
  type: 'stroke';
  undone: boolean;
  code?: string;
  reason?: string;
}

export type AgentMessage =
  | AgentWelcome
  | StrokeAnswer
  | { type: 'error'; code: string; reason: string; fatal: boolean }
  /** `redirect`: the address of the server that has the session; empty: none is named. */
  | { type: 'bye'; reason: string; redirect: string }
  /** A tool was made: its text is for the page's copy of the block. */
  | { type: 'tools' }
  /** The list in `AgentWelcome.others` has changed. */
  | { type: 'servers'; others: string[] };

function othersOf(from: Json): string[] {
  return Array.isArray(from['others']) ? from['others'].map(String) : [];
}

function welcomeOf(from: Json): AgentWelcome {
  const limits = object(from['limits'], 'limits');
  const resume = object(from['resume'], 'resume');
  return {
    type: 'welcome',
    participant: number(from, 'participant'),
    epoch: number(from, 'epoch'),
    color: colorOf(from['color']),
    speedMmPerS: number(limits, 'speed_mm_per_s'),
    samplesPerMessage: number(limits, 'samples_per_message'),
    samplesPerS: number(limits, 'samples_per_s'),
    resume: {
      token: text(resume, 'token'),
      resumed: flag(resume, 'resumed'),
      agentSequence: BigInt(Math.trunc(number(resume, 'agent_sequence'))),
    },
    others: othersOf(from),
  };
}

function messageOf(from: Json): AgentMessage | null {
  switch (from['type']) {
    case 'welcome':
      return welcomeOf(from);
    case 'stroke':
      return {
        type: 'stroke',
        undone: flag(from, 'undone'),
        ...(from['code'] === undefined
          ? {}
          : { code: text(from, 'code'), reason: text(from, 'reason') }),
      };
    case 'error':
      return {
        type: 'error',
        code: text(from, 'code'),
        reason: text(from, 'reason'),
        fatal: flag(from, 'fatal'),
      };
    case 'bye':
      return {
        type: 'bye',
        reason: text(from, 'reason'),
        redirect: from['redirect'] === undefined ? '' : text(from, 'redirect'),
      };
    case 'tools':
      return { type: 'tools' };
    case 'servers':
      return { type: 'servers', others: othersOf(from) };
    default:
      return null;
  }
}

/** Parses one text frame to an agent; the value is null for messages that this page does not use. */
export function parseAgentControl(frame: string): Decoded<AgentMessage | null> {
  try {
    return { ok: true, value: messageOf(object(JSON.parse(frame), 'message')) };
  } catch (problem) {
    const { message: reason } = problem as Error;
    return { ok: false, error: { code: 'bad_json', offset: 0, reason } };
  }
}
