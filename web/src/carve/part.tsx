// SPDX-License-Identifier: Apache-2.0
// The action that begins and ends carving. All else of it is a chunk of its own.

import { effect, signal } from '@preact/signals';
import type { VNode } from 'preact';
import { t } from '../strings';
import type { ButtonAction } from '../ui/actions';
import { ICONS } from '../ui/icons';
import { Live } from '../ui/live';
import type { CarveMode } from './carve_mode';
import type { CarveHost } from './host';
import { whyNotCarve } from './reasons';
import { VrPart } from './vr/part';
import type { VrState } from './vr/vr_mode';

export class CarvePart {
  readonly action: ButtonAction;
  readonly vr: VrPart;
  private readonly mode_ = signal<CarveMode | null>(null);
  private loading_: Promise<CarveMode | null> | null = null;
  private hasBegun_ = false; // by the headset

  constructor(private readonly host: CarveHost) {
    this.action = {
      ...{ name: 'carve', label: t('Carve'), key: 'C', icon: ICONS.carve },
      whyNot: () => this.whyNot_(),
      isShown: () => !host.shell.isCarving.value,
      perform: () => this.toggle(),
    };
    this.vr = new VrPart(host, {
      begin: async () => {
        const carving = this.whyNot_() === '' ? await this.load_() : null;
        this.hasBegun_ = carving?.isActive === false;
        host.begins();
        carving?.enter();
        return carving?.wielded ?? null;
      },
      leave: () => {
        if (this.hasBegun_) this.mode_.peek()?.leave();
        this.hasBegun_ = false;
      },
    });
  }

  /** Begins to carve, or ends it; says why not where this viewer may not. */
  toggle(): void {
    const mode = this.mode_.peek();
    if (mode?.isActive) {
      mode.leave();
      return;
    }
    const reason = this.whyNot_();
    if (reason !== '') {
      this.host.say(reason);
      return;
    }
    void this.load_().then((loaded) => {
      this.host.begins();
      loaded?.enter();
    });
  }

  /** Begins once session and picture are there, if this viewer may. */
  beginSoon(): void {
    const { model, picture } = this.host;
    const stop = effect(() => {
      if (!model.welcome || picture.viewer === null) return;
      queueMicrotask(() => {
        stop();
        if (!this.isActive && this.whyNot_() === '') this.toggle();
      });
    });
  }

  /** The bar with tool, depth, undo and messages, while one carves. */
  bar(): VNode {
    return <Live view={() => this.mode_.value?.bar()} />;
  }

  /** The force and the drag of the tool, over the picture, while one carves. */
  marks(): VNode {
    return (
      <div class="overlay" aria-hidden="true">
        <Live view={() => this.mode_.value?.marks()} />
      </div>
    );
  }

  get isActive(): boolean {
    return this.mode_.peek()?.isActive ?? false;
  }

  /** Whether something of the path is still drawn, sent or not answered. */
  get isBusy(): boolean {
    return this.mode_.peek()?.isBusy ?? false;
  }

  /** The hash of the page's copy of the block; null: it has none. */
  copyHash(): Promise<string | null> | null {
    return this.mode_.peek()?.copyHash() ?? null;
  }

  /** The state of the headset; null without one. */
  get vrState(): VrState | null {
    return this.vr.state;
  }

  /** Why this viewer may not carve now, tracked as signals are; empty: it may. */
  private whyNot_(): string {
    const { welcome } = this.host.model;
    if (!welcome) return t('The session is still loading.');
    const reason = whyNotCarve(welcome);
    const hasPicture = this.host.picture.viewer !== null;
    return reason !== '' || hasPicture ? reason : t('The view is still loading.');
  }

  /** After a failure the next call tries again. */
  private load_(): Promise<CarveMode | null> {
    const { host } = this;
    return (this.loading_ ??= import('./carve_mode').then(
      ({ CarveMode }) => (this.mode_.value = new CarveMode(host, host.picture.viewer!)),
      (problem: unknown) => {
        this.loading_ = null;
        console.warn('Carving did not load:', problem);
        return null;
      },
    ));
  }
}
