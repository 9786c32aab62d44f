// SPDX-License-Identifier: Apache-2.0

/** An uninterrupted series of motions of one participant. */
export interface Stroke {
  /** Number of its first record in the journal. */
  id: number;
  /** Number of its last record; those of others are between them. */
  last: number;
  participant: number;
  tool: number;
  motions: number;
  /** Wall time, ms since 1970. */
  begin_ms: number;
  end_ms: number;
  undone: boolean;
}

export type StrokeChange = 'undo' | 'redo';
