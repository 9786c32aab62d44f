// SPDX-License-Identifier: Apache-2.0
// The action that enters a headset, where the browser has one. All else of it is a chunk of its own.

import { signal } from '@preact/signals';
import { t } from '../../strings';
import type { ButtonAction } from '../../ui/actions';
import { ICONS } from '../../ui/icons';
import type { SessionModel } from '../../model/session';
import type { Picture } from '../../ui/picture';
import type { Wielded } from '../tool/wielded';
import type { VrMode, VrState } from './vr_mode';

/** The parts of the page that a headset uses. */
export interface VrHost {
  model: SessionModel;
  picture: Picture;
  /** Says why something is not done. */
  say: (text: string) => void;
  /** Does the page's work of one frame. */
  frame: (nowMs: number) => void;
}

/** Carving with the headset. */
export interface VrCarving {
  /** Begins to carve; null: this viewer may not. */
  begin: () => Promise<Wielded | null>;
  /** Leaves what begin() has begun. */
  leave: () => void;
}

export class VrPart {
  readonly action: ButtonAction;
  private readonly xr_ = (navigator as { xr?: XRSystem }).xr;
  private readonly isSupported_ = signal(false);
  private mode_: VrMode | null = null;
  private isBusy_ = false;

  constructor(
    private readonly host: VrHost,
    private readonly carving: VrCarving,
  ) {
    this.action = {
      ...{ name: 'vr', label: t('Enter VR'), key: '', icon: ICONS.headset },
      isShown: () => this.isSupported_.value,
      perform: () => void this.enter_(),
    };
    this.xr_?.isSessionSupported('immersive-vr').then(
      (isSupported) => (this.isSupported_.value = isSupported),
      () => undefined, // forbidden by a policy: as if there were none
    );
  }

  /** The state of the headset; null while it is off. */
  get state(): VrState | null {
    return this.mode_?.state ?? null;
  }

  private async enter_(): Promise<void> {
    const { host, xr_: xr } = this;
    const { viewer } = host.picture;
    if (this.isBusy_ || !xr || !viewer || !host.model.welcome) return;
    this.isBusy_ = true;
    try {
      // At once: a browser allows it only as the answer to a press.
      const asked = xr.requestSession('immersive-vr', { requiredFeatures: ['local-floor'] });
      const code = import('./vr_mode');
      const session = await asked;
      session.addEventListener('end', () => (this.isBusy_ = false));
      const { VrMode } = await code;
      const mode = new VrMode(session, {
        model: host.model,
        viewer,
        wielded: await this.carving.begin(),
        color: host.model.welcome.color,
        frame: host.frame,
        ended: () => {
          this.mode_ = null;
          this.carving.leave();
        },
      });
      await mode.begin();
      this.mode_ = mode;
    } catch (problem) {
      this.isBusy_ = false;
      this.carving.leave();
      host.say(t('The headset could not start: {0}', (problem as Error).message));
    }
  }
}
