// SPDX-License-Identifier: Apache-2.0
// A panel whose code is a chunk of its own, loaded when the panel is opened first.

import { signal } from '@preact/signals';

export interface Panel {
  toggle: () => void;
}

export class LazyPanel<P extends Panel> {
  private readonly loaded_ = signal<P | null>(null);
  private isLoading_ = false;

  /** @param name for the console */
  constructor(
    private readonly name: string,
    private readonly load: () => Promise<P>,
  ) {}

  /** The panel, as a signal's value; null until it is loaded. */
  get loaded(): P | null {
    return this.loaded_.value;
  }

  /**
   * Opens or closes the panel. A chunk that did not load is loaded again by the next call.
   */
  toggle(): void {
    const panel = this.loaded_.peek();
    if (panel) panel.toggle();
    else if (!this.isLoading_) void this.open_();
  }

  private async open_(): Promise<void> {
    this.isLoading_ = true;
    try {
      const panel = await this.load();
      this.loaded_.value = panel;
      panel.toggle();
    } catch (problem) {
      console.warn(`The ${this.name} did not load:`, problem);
    }
    this.isLoading_ = false;
  }
}
