// SPDX-License-Identifier: Apache-2.0
// Who is at the block, and what their tools do. Two messages feed it: the participants list (names, colours) and the tool
// states (poses, forces); either may arrive first, so an entry exists as soon as the list names it, and a tool state of somebody
// unknown waits for the list.

import type { ParticipantInfo, ToolState } from '../wire/types';
import { ForceHistory } from './forces';
import { PoseTrack } from './pose_track';

export const FORCE_WINDOW_S = 10;

export interface Participant {
  info: ParticipantInfo;
  track: PoseTrack;
  forces: ForceHistory;
  /** Tool and status of the newest tool state; tool 0 until there is one. */
  tool: number;
  status: number;
  /** Local time of the newest tool state, ms. */
  seenMs: number;
}

export class Participants {
  private readonly byId_ = new Map<number, Participant>();
  private revision_ = 0;

  /** Takes over a complete list: new ones are added, changed ones renamed, those not in it are gone. */
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
          seenMs: -Infinity,
        });
      }
    }
    for (const id of this.byId_.keys()) {
      if (!present.has(id)) this.byId_.delete(id);
    }
    this.revision_ += 1;
  }

  /** Takes over one tools frame. `timeMs` is the server's time of the frame on the viewer's clock. */
  applyTools(tools: readonly ToolState[], timeMs: number): void {
    for (const state of tools) {
      const participant = this.byId_.get(state.participant);
      if (!participant || timeMs <= participant.seenMs) continue;
      participant.track.push(timeMs, state);
      participant.tool = state.tool_id;
      participant.status = state.status;
      participant.seenMs = timeMs;
      participant.forces.push(timeMs / 1000, Math.hypot(...state.force_n), Math.hypot(...state.torque_nmm));
    }
  }

  /** A new connection: poses of the old one must not be mixed with those to come. */
  forgetPoses(): void {
    for (const participant of this.byId_.values()) {
      participant.track.clear();
      participant.seenMs = -Infinity;
    }
  }

  get(id: number): Participant | undefined {
    return this.byId_.get(id);
  }

  /** Those who carve, first come first. */
  carvers(): Participant[] {
    return this.all().filter((p) => p.info.kind !== 'viewer');
  }

  all(): Participant[] {
    return [...this.byId_.values()].sort((a, b) => a.info.participant - b.info.participant);
  }

  /** Grows whenever the list changes, so that the page redraws it only then. */
  get revision(): number {
    return this.revision_;
  }
}
