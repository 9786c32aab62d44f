// SPDX-License-Identifier: Apache-2.0
// The button that shows the stock as it was before the first cut.

import { t } from '../../strings';
import { ask } from '../../link/server_error';
import { pathOf } from '../../link/address';
import { GhostView } from '../../view/inspect/ghost_view';
import type { Viewer } from '../../view/viewer';

export class Ghost {
  private view_: GhostView | null = null;
  private isWanted_ = false;
  private loading_: Promise<ArrayBuffer> | null = null;

  /** @param button pressed while the stock is shown */
  constructor(
    private readonly viewer: Viewer,
    private readonly session: string,
    private readonly button: HTMLButtonElement,
    private readonly failed: (reason: string) => void,
  ) {
    button.title = t('Show the stock before the first cut');
  }

  toggle(): void {
    this.show(!this.isWanted_);
  }

  show(wanted: boolean): void {
    this.isWanted_ = wanted;
    this.button.setAttribute('aria-pressed', String(wanted));
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
      if (this.isWanted_ && !this.view_) this.view_ = new GhostView(this.viewer, stl);
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
