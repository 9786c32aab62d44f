// SPDX-License-Identifier: Apache-2.0
// Programs, as the server lists them.

export type ProgramState =
  'queued' | 'running' | 'paused' | 'finished' | 'cancelled' | 'failed' | 'unknown';

/** An NC program that the server carves, as lists show it. */
export interface ProgramInfo {
  id: number;
  participant: number;
  name: string;
  pace: 'feed' | 'fast';
  /** Times the feed rate, at the pace `feed`. */
  speed?: number;
  state: ProgramState;
  /** Of a queued one: begins when this program has finished. */
  after?: number;
  /** The server's disk does not keep up. */
  waiting: boolean;
  motions_done: number;
  motions: number;
  line: number;
  tool: number;
  feed_mm_per_min: number;
  /** Cycle time at feed rate, and its parts before and after now. */
  programmed_s: number;
  elapsed_s: number;
  remaining_s: number;
  removed_volume_mm3: number;
  alarm_count: number;
  error?: string;
}

/** The programs that have not ended and the newest that have; replaces the message before. */
export interface ProgramsMessage {
  type: 'programs';
  programs: ProgramInfo[];
}
