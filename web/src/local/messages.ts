// SPDX-License-Identifier: Apache-2.0
// The messages between a page that carves by itself and its worker.

import type { TileTriangles } from '../kernel/kernel';
import type { ToolInfo } from '../wire/types';
import type {
  About,
  GivenFiles,
  GivenJournal,
  JournalParts,
  Progress,
  TakeHomeFormat,
  TileDigest,
} from './program_block';

export type ToWorker =
  /** kerf_files.wasm, compiled. */
  | { type: 'load'; module: WebAssembly.Module }
  /** Files to read; their program is carved to its end. */
  | { type: 'open'; files: GivenFiles }
  /** A journal to read. It is replayed up to a record; `isSilent`: nothing of it is displayed. */
  | { type: 'journal'; journal: GivenJournal; to: number; isSilent: boolean }
  /** Further records of the journal. */
  | { type: 'records'; span: Uint8Array<ArrayBuffer> }
  /** Carves forward to a motion or record, one after the other. */
  | { type: 'carve'; to: number }
  /** Carves forward or goes back to so many motions, or records. */
  | { type: 'seek'; motion: number }
  /** Plays on with forces, so many times as fast as it was carved; to be ended by the others. */
  | { type: 'play'; rate: number }
  /** Asks for the digests of tiles that have changed since the last time; at first of all. */
  | { type: 'digests' }
  /** Asks for the mesh of a tile as it was at the last `digests`. */
  | { type: 'mesh'; x: number; y: number }
  /** Ends carving where it is. */
  | { type: 'stop' }
  | { type: 'model'; format: TakeHomeFormat }
  /** A hand carves from now on, as this participant: `handed` follows when it may. */
  | { type: 'hand'; participant: number; wallMs: number }
  /** A frame of motions of the hand, up to the sample `newest`. */
  | {
      type: 'samples';
      frame: Uint8Array;
      newest: bigint;
      wallMs: number;
      spanMs: number;
    }
  /** Undoes the newest stroke of the hand, or redoes the one that it undid last. */
  | { type: 'change'; undone: boolean; wallMs: number }
  /** Makes a tool for the hand: the JSON of one in a scene. */
  | { type: 'tool'; tool: string; wallMs: number }
  /** The hand rests: the state hash is computed. */
  | { type: 'rest' }
  /** Requests a journal of the hand's strokes. */
  | { type: 'save' };

export type FromWorker =
  /** The block is made. `path`: as model/program_path.ts reads it. */
  | { type: 'opened'; about: About; path: unknown }
  /** How far it is, with the tiles that have changed since the last one. */
  | {
      type: 'carved';
      progress: Progress;
      tiles: TileTriangles[];
      /** Of the state, once it rests; while it plays, each second. */
      hash: string | null;
      /** With which it plays; 0: it does not. */
      rate: number;
      /** Time of carving alone since `opened`, ms. */
      carvingMs: number;
    }
  | { type: 'digests'; tiles: TileDigest[] }
  | { type: 'mesh'; tile: TileTriangles }
  | { type: 'model'; format: TakeHomeFormat; bytes: Uint8Array<ArrayBuffer> }
  /** The block is at its last record, and is a journal's: the hand may carve. */
  | { type: 'handed'; about: About }
  /**
   * Samples up to `newest` are carved; `recorded`: a motion of them is; `reason`: why one was
   * rejected, else empty.
   */
  | { type: 'felt'; newest: bigint; progress: Progress; recorded: boolean; reason: string }
  /** `reason`: why nothing was undone or redone, else empty. */
  | { type: 'changed'; undone: boolean; reason: string }
  /** The id of the tool that was asked for, and all tools; `reason`: why there is none, else empty. */
  | { type: 'tool'; id: number; tools: ToolInfo[]; reason: string }
  | { type: 'saved'; parts: JournalParts }
  /** Files cannot be read, or a motion cannot be carved: one line, that of kerf-carve. */
  | { type: 'rejected'; reason: string }
  /** The model cannot be written. */
  | { type: 'unwritten'; reason: string }
  /** The worker has ended. */
  | { type: 'failed'; reason: string };
