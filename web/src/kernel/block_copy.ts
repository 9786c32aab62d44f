// SPDX-License-Identifier: Apache-2.0
// The page's copy of the block, in a worker: the page's cuts appear there at once, made by the
// server's own kernel.

import type { TileTriangles } from './kernel';
import type { FromWorker, ToWorker } from './messages';

export interface CopyEvents {
  /** Tiles as they are with the page's samples up to `newest`. */
  tiles(tiles: TileTriangles[], newest: bigint): void;
  /** Tiles follow that have an undo or redo before the server has. */
  changes(): void;
  /** The greatest cutting force of a frame's motions, N: sooner than the server's answer. */
  felt(forceN: number): void;
  /** The server must send its stock again. */
  lacks(): void;
  /** The copy has ended: cuts are shown when the server's mesh comes. */
  failed(reason: string): void;
}

/** The part of Worker that is used. */
export interface WorkerPort {
  onmessage: ((event: { data: FromWorker }) => void) | null;
  /** Its code did not load, or ended in an error. */
  onerror: ((event: { message?: string }) => void) | null;
  /** Its message cannot be read. */
  onmessageerror: (() => void) | null;
  postMessage(message: ToWorker): void;
}

export class BlockCopy {
  /** Whether there is a kernel for pages. */
  readonly isThere: Promise<boolean>;
  private works_ = false;
  private asked_ = 0;
  private readonly hashes_ = new Map<number, (hash: string | null) => void>();

  /** `module` is kerf.wasm, or null where there is none. */
  constructor(
    module: Promise<WebAssembly.Module | null>,
    private readonly worker: WorkerPort,
    private readonly events: CopyEvents,
  ) {
    let tell: (isThere: boolean) => void;
    this.isThere = new Promise((resolve) => (tell = resolve));
    worker.onmessage = ({ data }) => {
      if (data.type === 'loaded') this.works_ = true;
      if (data.type === 'failed') this.works_ = false;
      if (data.type === 'loaded' || data.type === 'failed') tell(this.works_);
      this.received_(data);
    };
    const end = (reason: string): void => {
      this.works_ = false;
      tell(false);
      for (const answer of this.hashes_.values()) answer(null);
      this.hashes_.clear();
      events.failed(reason);
    };
    worker.onerror = ({ message }) => end(message ?? 'Its worker did not load.');
    worker.onmessageerror = () => end('A message of its worker cannot be read.');
    module.then(
      (compiled) => {
        if (compiled) worker.postMessage({ type: 'load', module: compiled });
        else tell(false);
      },
      (problem: unknown) => end((problem as Error).message),
    );
  }

  /** Whether it takes frames. */
  get works(): boolean {
    return this.works_;
  }

  /** A block begins: the text of an agent's welcome. */
  open(welcome: string): void {
    this.worker.postMessage({ type: 'open', welcome });
  }

  /** Tools were made: the text of a `tools` message. */
  tools(message: string): void {
    if (this.works_) this.worker.postMessage({ type: 'tools', message });
  }

  /** Takes a frame of the server. */
  take(frame: Uint8Array): void {
    if (this.works_) this.worker.postMessage({ type: 'take', frame });
  }

  /** Cuts the motions of a frame that is sent; `newest` is its last sample. */
  cut(frame: Uint8Array, newest: bigint): void {
    if (this.works_) this.worker.postMessage({ type: 'cut', frame, newest });
  }

  /** The server is asked to undo (true) or redo a stroke of the page: it is displayed at once. */
  change(undone: boolean): void {
    if (!this.works_) return;
    this.events.changes();
    this.worker.postMessage({ type: 'change', undone });
  }

  /** The server has refused, or has sent all: the server's state is displayed. */
  settle(): void {
    if (this.works_) this.worker.postMessage({ type: 'settle' });
  }

  /** The server's meshes of these tiles are displayed again. */
  hidden(keys: number[]): void {
    if (this.works_ && keys.length > 0) this.worker.postMessage({ type: 'hidden', keys });
  }

  /** The hash of its state; null: there is no block. */
  hash(): Promise<string | null> {
    const id = ++this.asked_;
    return new Promise((resolve) => {
      this.hashes_.set(id, resolve);
      this.worker.postMessage({ type: 'hash', id });
    });
  }

  private received_(message: FromWorker): void {
    switch (message.type) {
      case 'loaded':
        return;
      case 'tiles':
        this.events.tiles(message.tiles, message.newest);
        return;
      case 'felt':
        this.events.felt(message.forceN);
        return;
      case 'lacks':
        this.events.lacks();
        return;
      case 'failed':
        this.events.failed(message.reason);
        return;
      case 'hash':
        this.hashes_.get(message.id)?.(message.hash);
        this.hashes_.delete(message.id);
    }
  }
}
