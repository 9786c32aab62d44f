// SPDX-License-Identifier: Apache-2.0
// The participants of the session and the state of their tools, fed by two messages: the
// participants list (names, colors) and the tool states (poses, forces). Either may arrive first.
// The list creates the entries; tool states of unknown participants are ignored.

import { STATUS_FELT } from '../wire/types';
import type { ParticipantInfo, ToolState } from '../wire/types';
import { ForceHistory } from './forces';
import { PoseTrack } from './pose_track';

export const FORCE_WINDOW_S = 10;

export interface Participant {
  info: ParticipantInfo;
  track: PoseTrack;
  forces: ForceHistory;
  /**
   * Tool and status of the newest tool state; before the first one, the tool of the list (0: none).
   */
  tool: number;
  status: number;
  /** Share of force and torque that the participant's device outputs; null: not stated. */
  feltShare: number | null;
  /** Local time of the newest tool state, ms; -Infinity before the first one. */
  seenMs: number;
}

export class Participants {
  private readonly byId_ = new Map<number, Participant>();
  private revision_ = 0;

  /** Replaces the list: adds new participants, updates known ones, removes those not in it. */
  setList(list: readonly ParticipantInfo[]): void {
    const present = new Set<number>();
    for (const info of list) {
      present.add(info.participant);
      const known = this.byId_.get(info.participant);
      if (known) {
        known.info = info;
      } else {
        this.byId_.set(info.participant, {
          info,
          track: new PoseTrack(),
          forces: new ForceHistory(FORCE_WINDOW_S),
          tool: info.tool ?? 0,
          status: 0,
          feltShare: null,
          seenMs: -Infinity,
        });
      }
    }
    for (const id of this.byId_.keys()) {
      if (!present.has(id)) this.byId_.delete(id);
    }
    this.revision_ += 1;
  }

  /** Applies one tools frame. `timeMs` is the frame's server time, mapped to the local clock. */
  applyTools(tools: readonly ToolState[], timeMs: number): void {
    for (const state of tools) {
      const participant = this.byId_.get(state.participant);
      if (!participant || timeMs <= participant.seenMs) continue;
      participant.track.push(timeMs, state);
      participant.tool = state.tool_id;
      participant.status = state.status;
      participant.feltShare = state.status & STATUS_FELT ? state.felt_share : null;
      participant.seenMs = timeMs;
      participant.forces.push(
        timeMs / 1000,
        Math.hypot(...state.force_n),
        Math.hypot(...state.torque_nmm),
      );
    }
  }

  /** Clears all poses, so that those of two connections are never mixed. */
  forgetPoses(): void {
    for (const participant of this.byId_.values()) {
      participant.track.clear();
      participant.seenMs = -Infinity;
      participant.feltShare = null;
    }
  }

  get(id: number): Participant | undefined {
    return this.byId_.get(id);
  }

  /** Agents and programs, in order of joining. */
  carvers(): Participant[] {
    return this.all().filter((p) => p.info.kind !== 'viewer');
  }

  all(): Participant[] {
    return [...this.byId_.values()].sort((a, b) => a.info.participant - b.info.participant);
  }

  /** Counter of list changes, so that the page rebuilds its list only after a change. */
  get revision(): number {
    return this.revision_;
  }
}
