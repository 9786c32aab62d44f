// SPDX-License-Identifier: Apache-2.0
// The program's tool, where the block is.

import { t } from '../strings';
import type { SessionModel } from '../model/session';
import { FrameType, STATUS_CUTTING } from '../wire/types';
import type { ParticipantInfo, ToolState } from '../wire/types';
import type { Progress } from './program_block';

/** Also in the journal of a hand that goes on from a program (web/wasm/files). */
const PARTICIPANT = 1;
const COLOR = '#b5500b';

/** The program as a participant. */
export function programAs(name: string, tool: number): ParticipantInfo {
  return {
    participant: PARTICIPANT,
    name,
    color: COLOR,
    tool,
    kind: 'program',
  };
}

export class ToolTrack {
  constructor(private readonly model: SessionModel) {}

  /** Shows the tool at the end of the carved motions, unless the program has ended. */
  show({ tool, tip_mm, axis }: Progress, moves: boolean): void {
    if (!moves || tool === undefined || !tip_mm || !axis) {
      this.clear();
      return;
    }
    const { participants } = this.model;
    if (!participants.get(PARTICIPANT))
      participants.setList([programAs(t('Tool {0}', tool), tool)]);
    const nowMs = performance.now();
    const state: ToolState = {
      participant: PARTICIPANT,
      tool_id: tool,
      tip_mm,
      axis,
      status: STATUS_CUTTING,
      force_n: [0, 0, 0],
      torque_nmm: [0, 0, 0],
      removed_rate_mm3_per_s: 0,
      felt_share: 0,
    };
    const time_us = BigInt(Math.round(1000 * nowMs));
    const header = { type: FrameType.Tools, flags: 0, epoch: 1, sequence: 0n, time_us };
    this.model.applyTools(header, [state], nowMs);
  }

  /** Shows the tools of a journal. */
  showAll(tools: readonly Omit<ToolState, 'felt_share'>[]): void {
    const states = tools.map((tool) => ({ ...tool, felt_share: 0 }));
    this.model.participants.applyTools(states, performance.now());
  }

  clear(): void {
    this.model.participants.setList([]);
  }
}
