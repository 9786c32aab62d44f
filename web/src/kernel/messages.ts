// SPDX-License-Identifier: Apache-2.0
// The messages between the page and the worker with its copy of the block.

import type { TileTriangles } from './kernel';

export type ToWorker =
  /** kerf.wasm, compiled. */
  | { type: 'load'; module: WebAssembly.Module }
  /** A block begins: the text of an agent's welcome. */
  | { type: 'open'; welcome: string }
  /** A message of the server that lists tools: those that are new are defined. */
  | { type: 'tools'; message: string }
  /** A frame of the server. */
  | { type: 'take'; frame: Uint8Array }
  /** A frame with motions of the page, which is cut at once. `newest` is its last sample. */
  | { type: 'cut'; frame: Uint8Array; newest: bigint }
  /** The page asks the server to undo its newest stroke, or to redo the one that it undid last. */
  | { type: 'change'; undone: boolean }
  /** The server has refused, or has sent all. */
  | { type: 'settle' }
  /** The server's meshes of these tiles are displayed again. */
  | { type: 'hidden'; keys: number[] }
  | { type: 'hash'; id: number };

export type FromWorker =
  /** The module runs. */
  | { type: 'loaded' }
  /** Tiles that the page has cut, and later changes of those that it displays. */
  | { type: 'tiles'; tiles: TileTriangles[]; newest: bigint }
  /** The greatest cutting force of the page's motions in a frame, N. */
  | { type: 'felt'; forceN: number }
  /** The server must send its stock again. */
  | { type: 'lacks' }
  /** The copy has ended. */
  | { type: 'failed'; reason: string }
  | { type: 'hash'; id: number; hash: string | null };
