// SPDX-License-Identifier: Apache-2.0
// The section of the panel for pins, shared views and pictures. Most of its code is a chunk, which is
// loaded when there are pins or shared views, or when a button is pressed.

import { effect, signal } from '@preact/signals';
import type { VNode } from 'preact';
import { Live } from '../live';
import type { TogetherHost } from './host';
import { TogetherSection } from './section';
import type { Command } from './section';
import { TogetherState } from './state';
import type { TogetherPanel } from './together_panel';

export class TogetherPart {
  private readonly state_ = new TogetherState();
  private readonly panel_ = signal<TogetherPanel | null>(null);
  private loading_: Promise<void> | null = null;

  constructor(private readonly host: TogetherHost) {
    effect(() => {
      const { pins, cameras } = host.model.together;
      if (host.picture.viewer && pins.length + cameras.length > 0) void this.load_();
    });
  }

  /** Called about ten times a second: sends the camera while it is shared. */
  update(): void {
    this.panel_.peek()?.update();
  }

  section(): VNode {
    return (
      <TogetherSection
        host={this.host}
        state={this.state_}
        panel={this.panel_}
        press={(command) => void this.press_(command)}
      />
    );
  }

  /** The dialog for the text of a pin. */
  dialog(): VNode {
    return <Live view={() => this.panel_.value?.dialog()} />;
  }

  private async press_(command: Command): Promise<void> {
    await this.load_();
    this.panel_.peek()?.[command]();
  }

  private load_(): Promise<void> {
    this.loading_ ??= this.open_().catch((problem: unknown) => {
      this.loading_ = null;
      console.warn('The section “Together” did not load:', problem);
    });
    return this.loading_;
  }

  private async open_(): Promise<void> {
    const { TogetherPanel: Panel } = await import('./together_panel');
    const { host } = this;
    if (host.picture.viewer) this.panel_.value = new Panel(host, host.picture.viewer, this.state_);
    else this.loading_ = null;
  }
}
