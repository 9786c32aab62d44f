// SPDX-License-Identifier: Apache-2.0
// What the page without a server and its worker say to each other.

import type { TileTriangles } from '../kernel/kernel';
import type { About, GivenFiles, Progress, TakeHomeFormat } from './program_block';

export type ToWorker =
  /** kerf_files.wasm, compiled. */
  | { type: 'load'; module: WebAssembly.Module }
  /** Files to read; their program is carved to its end. */
  | { type: 'open'; files: GivenFiles }
  /** Carves forward or goes back to so many motions. */
  | { type: 'seek'; motion: number }
  /** Ends carving where it is. */
  | { type: 'stop' }
  | { type: 'model'; format: TakeHomeFormat };

export type FromWorker =
  /** The block is made. `path`: as model/program_path.ts reads it. */
  | { type: 'opened'; about: About; path: unknown }
  /** How far it is, with the tiles that have changed since the last one. */
  | {
      type: 'carved';
      progress: Progress;
      tiles: TileTriangles[];
      /** Of the state, once it rests. */
      hash: string | null;
      /** Time of carving alone since `opened`, ms. */
      carvingMs: number;
    }
  | { type: 'model'; format: TakeHomeFormat; bytes: Uint8Array<ArrayBuffer> }
  /** Files cannot be read, or a motion cannot be carved: one line, that of kerf-carve. */
  | { type: 'rejected'; reason: string }
  /** The model cannot be written. */
  | { type: 'unwritten'; reason: string }
  /** The worker has ended. */
  | { type: 'failed'; reason: string };
