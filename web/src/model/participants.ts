// SPDX-License-Identifier: Apache-2.0
// The participants of the session and the state of their tools, fed by the participants list (names,
// colors) with its changes, and by the tool states (poses, forces). Either may arrive first.
// The list creates the entries; tool states of unknown participants are ignored, but in the past, where
// they are of participants who have left.

import { signal } from '@preact/signals';
import { t } from '../strings';
import { STATUS_FELT } from '../wire/types';
import type { ParticipantInfo, ParticipantsChanged, ToolState } from '../wire/types';
import { ForceHistory } from './forces';
import { PoseTrack } from './pose_track';

export const FORCE_WINDOW_S = 10;

const UNKNOWN_COLORS = ['#4f6d9a', '#8a5a83', '#5c7d4a', '#a0622d', '#3f7f86', '#7a6248'];

/** The color of a participant who left before this page came. */
export function colorOfUnknown(participant: number): string {
  return UNKNOWN_COLORS[participant % UNKNOWN_COLORS.length]!;
}

/** Who carves, or has carved. */
export interface Author {
  participant: number;
  name: string;
  /** #rrggbb */
  color: string;
}

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

function isSamePerson(viewer: ParticipantInfo, { kind, name, color }: ParticipantInfo): boolean {
  return kind === 'agent' && name === viewer.name && color === viewer.color;
}

export class Participants {
  private readonly byId_ = new Map<number, Participant>();
  private readonly authors_ = new Map<number, Author>(); // also those who have left
  private readonly revision_ = signal(0); // counts changes of the list
  private readonly viewers_ = signal(0);
  /**
   * The past is shown: frames of tools have all that are known, also those of participants who have
   * left.
   */
  looksBack = false;

  /**
   * Replaces the list: adds new participants, updates known ones, removes those not in it. `viewers`
   * counts the viewers, of which the list may contain none; without it they are those in the list.
   */
  setList(list: readonly ParticipantInfo[], viewers?: number): void {
    const present = new Set(list.map((info) => info.participant));
    for (const info of list) this.put_(info);
    for (const id of this.byId_.keys()) {
      if (!present.has(id)) this.byId_.delete(id);
    }
    this.viewers_.value = viewers ?? list.filter((info) => info.kind === 'viewer').length;
    this.changed_();
  }

  /** Applies a change of the list. */
  change(change: ParticipantsChanged): void {
    for (const info of change.changed) this.put_(info);
    for (const id of change.left) this.byId_.delete(id);
    this.viewers_.value = change.viewers;
    this.changed_();
  }

  /** Takes who could carve, as the server tells it of those who have left, too. */
  learn(authors: readonly Author[]): void {
    for (const author of authors) {
      const { participant, name, color } = author;
      const known = this.byId_.get(participant);
      if (known && this.authors_.has(participant)) continue; // the list is newer
      this.authors_.set(participant, author);
      if (known) known.info = { ...known.info, name, color };
    }
    this.changed_();
  }

  /** Who a participant is or was; undefined: it left before the page came. */
  author(participant: number): Author | undefined {
    this.track_();
    return this.authors_.get(participant);
  }

  /** Number of viewers, listed or not. */
  get viewers(): number {
    return this.viewers_.value;
  }

  /** Applies one tools frame. `timeMs` is the frame's server time, mapped to the local clock. */
  applyTools(tools: readonly ToolState[], timeMs: number): void {
    if (this.looksBack) this.forgetAllBut_(tools);
    for (const state of tools) {
      const participant = this.byId_.get(state.participant) ?? this.admit_(state);
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
    this.forgetAllBut_([]);
  }

  /** As all readers of the list: in a component or an effect, it is tracked as a signal. */
  get(id: number): Participant | undefined {
    this.track_();
    return this.byId_.get(id);
  }

  /** Agents and programs, in order of joining. */
  carvers(): Participant[] {
    return this.all().filter((p) => p.info.kind !== 'viewer');
  }

  all(): Participant[] {
    this.track_();
    return [...this.byId_.values()].sort((a, b) => a.info.participant - b.info.participant);
  }

  /** Viewers who do not carve as well. Who carves in the page has two connections. */
  watchers(): Participant[] {
    const carvers = this.carvers().map(({ info }) => info);
    return this.all().filter(
      ({ info }) => info.kind === 'viewer' && !carvers.some((carver) => isSamePerson(info, carver)),
    );
  }

  /** Whether a participant is the agent of a viewer, who carves in the page. */
  isAgentOf(viewer: number | undefined, { info }: Participant): boolean {
    const self = viewer === undefined ? undefined : this.get(viewer)?.info;
    return self !== undefined && isSamePerson(self, info);
  }

  /** Reads the signal that counts the changes of the list. */
  private track_(): number {
    return this.revision_.value;
  }

  private changed_(): void {
    this.revision_.value = this.revision_.peek() + 1;
  }

  private forgetAllBut_(tools: readonly ToolState[]): void {
    const known = new Set(tools.map(({ participant }) => participant));
    for (const [id, participant] of this.byId_) {
      if (known.has(id)) continue;
      participant.track.clear();
      participant.seenMs = -Infinity;
      participant.feltShare = null;
    }
  }

  private admit_({ participant, tool_id }: ToolState): Participant | undefined {
    if (!this.looksBack) return undefined;
    const { name, color } = this.authors_.get(participant) ?? {
      name: t('Participant {0}', participant),
      color: colorOfUnknown(participant),
    };
    this.enter_({ participant, name, color, kind: 'agent', tool: tool_id });
    this.changed_();
    return this.byId_.get(participant);
  }

  private put_(info: ParticipantInfo): void {
    const { participant, name, color, kind } = info;
    if (kind !== 'viewer') this.authors_.set(participant, { participant, name, color });
    this.enter_(info);
  }

  private enter_(info: ParticipantInfo): void {
    const known = this.byId_.get(info.participant);
    if (known) {
      known.info = info;
      return;
    }
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
