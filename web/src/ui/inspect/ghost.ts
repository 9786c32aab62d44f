// SPDX-License-Identifier: Apache-2.0
// Shows the stock as it was before the first cut.

import { signal } from '@preact/signals';
import { ask } from '../../link/server_error';
import { pathOf } from '../../link/address';
import { GhostView } from '../../view/inspect/ghost_view';
import type { Viewer } from '../../view/viewer';

export class Ghost {
  private view_: GhostView | null = null;
  /** Whether the stock is shown. */
  readonly isWanted = signal(false);
  private loading_: Promise<ArrayBuffer> | null = null;

  constructor(
    private readonly viewer: Viewer,
    private readonly session: string,
    private readonly failed: (reason: string) => void,
  ) {}

  toggle(): void {
    this.show(!this.isWanted.peek());
  }

  show(wanted: boolean): void {
    this.isWanted.value = wanted;
    if (wanted) void this.load_();
    else this.hide_();
  }

  private hide_(): void {
    this.view_?.dispose();
    this.view_ = null;
  }

  /** The stock does not change: it is asked for once. */
  private async load_(): Promise<void> {
    try {
      const stl = await (this.loading_ ??= this.fetch_());
      if (this.isWanted.peek() && !this.view_) this.view_ = new GhostView(this.viewer, stl);
    } catch (problem) {
      this.loading_ = null;
      this.show(false);
      this.failed((problem as Error).message);
    }
  }

  private async fetch_(): Promise<ArrayBuffer> {
    const response = await ask('GET', pathOf(this.session, 'model.stl?at=0'));
    return response.arrayBuffer();
  }
}
