// SPDX-License-Identifier: Apache-2.0
// The worker's side of the page's copy: takes frames, and meshes the tiles that the page has cut.
// Meshes are made when no message waits, so that many motions become one.

import { tileAt, tileKey } from '../model/tiles';
import { FrameType } from '../wire/types';
import type { Kernel } from './kernel';
import type { FromWorker, ToWorker } from './messages';

const TYPE_AT = 4; // of a frame's header

export class CopyKeeper {
  private kernel_: Kernel | null = null;
  private isOpen_ = false;
  private newest_ = 0n;
  private readonly shown_ = new Set<number>(); // the tiles of this copy that the page displays
  private readonly dirty_ = new Set<number>();
  private isDue_ = false;

  /** `load` makes a module run. */
  constructor(
    private readonly post: (message: FromWorker) => void,
    private readonly load: (module: WebAssembly.Module) => Promise<Kernel>,
    private readonly later: (act: () => void) => void,
  ) {}

  async receive(message: ToWorker): Promise<void> {
    try {
      if (message.type === 'load') {
        this.kernel_ = await this.load(message.module);
        this.post({ type: 'loaded' });
      } else if (this.kernel_) this.heard_(this.kernel_, message);
      else if (message.type === 'hash') this.post({ type: 'hash', id: message.id, hash: null });
    } catch (problem) {
      this.failed_(problem);
    }
  }

  private heard_(kernel: Kernel, message: Exclude<ToWorker, { type: 'load' }>): void {
    switch (message.type) {
      case 'open':
        kernel.open(message.welcome);
        this.isOpen_ = true;
        this.shown_.clear();
        this.dirty_.clear();
        return;
      case 'tools':
        if (this.isOpen_) kernel.tools(message.message);
        return;
      case 'hidden':
        for (const key of message.keys) this.shown_.delete(key);
        return;
      case 'hash':
        this.post({ type: 'hash', id: message.id, hash: this.isOpen_ ? kernel.hash() : null });
        return;
      case 'change':
        if (!this.isOpen_) return;
        this.collect_(kernel);
        kernel.change(message.undone);
        this.meshSoon_();
        return;
      case 'settle':
        if (!this.isOpen_) return;
        this.collect_(kernel);
        kernel.settle();
        this.meshSoon_();
        return;
      case 'cut':
        if (!this.isOpen_) return;
        kernel.take(message.frame);
        this.newest_ = message.newest;
        this.post({ type: 'felt', forceN: kernel.force() });
        this.meshSoon_();
        return;
      case 'take':
        if (this.isOpen_) this.take_(kernel, message.frame);
    }
  }

  private take_(kernel: Kernel, frame: Uint8Array): void {
    const isStock = frame[TYPE_AT] === FrameType.Stock;
    if (isStock) this.collect_(kernel);
    if (!kernel.take(frame)) this.post({ type: 'lacks' });
    if (!isStock) return;
    this.collect_(kernel);
    this.meshSoon_();
  }

  /** Other participants' cuts are displayed with the server's mesh, unless the page has one. */
  private collect_(kernel: Kernel): void {
    for (const { x, y, byPage } of kernel.changed()) {
      const key = tileKey(x, y);
      if (byPage || this.shown_.has(key)) this.dirty_.add(key);
    }
  }

  private meshSoon_(): void {
    if (this.isDue_) return;
    this.isDue_ = true;
    this.later(() => {
      this.isDue_ = false;
      try {
        if (this.kernel_) this.mesh_(this.kernel_);
      } catch (problem) {
        this.failed_(problem);
      }
    });
  }

  private mesh_(kernel: Kernel): void {
    this.collect_(kernel);
    if (this.dirty_.size === 0) return;
    const tiles = [...this.dirty_].map((key) => kernel.mesh(...tileAt(key)));
    for (const key of this.dirty_) this.shown_.add(key);
    this.dirty_.clear();
    this.post({ type: 'tiles', tiles, newest: this.newest_ });
  }

  private failed_(problem: unknown): void {
    this.kernel_ = null;
    this.post({ type: 'failed', reason: (problem as Error).message });
  }
}
