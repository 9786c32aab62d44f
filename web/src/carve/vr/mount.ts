// SPDX-License-Identifier: Apache-2.0
// The button that enters a headset, where the browser has one. All else of it is a chunk of its own.

import { t } from '../../strings';
import { iconButton } from '../../ui/dom';
import { ICONS } from '../../ui/icons';
import type { SessionModel } from '../../model/session';
import type { Picture } from '../../ui/picture';
import type { Wielded } from '../tool/wielded';
import type { VrState } from './vr_mode';

/** The parts of the page that a headset uses. */
export interface VrHost {
  model: SessionModel;
  picture: Picture;
  toolbar: HTMLElement;
  /** Says why something is not done. */
  say: (text: string) => void;
  /** Does the page's work of one frame. */
  frame: (nowMs: number) => void;
}

/** Carving, which goes on in the headset. */
export interface VrCarving {
  /** Begins to carve; null: this viewer may not. */
  begin: () => Promise<Wielded | null>;
  /** Leaves what begin() has begun. */
  leave: () => void;
}

/**
 * Adds the button once the browser says that there is a headset. Returns a getter of the headset's
 * state, null while it is off.
 */
export function mountVr(host: VrHost, carving: VrCarving): () => VrState | null {
  const { xr } = navigator as { xr?: XRSystem };
  let state: () => VrState | null = () => null;
  let isBusy = false;
  const enter = async (): Promise<void> => {
    const { viewer } = host.picture;
    const { welcome } = host.model;
    if (isBusy || !xr || !viewer || !welcome) return;
    isBusy = true;
    try {
      // At once: a browser allows it only as the answer to a press.
      const asked = xr.requestSession('immersive-vr', { requiredFeatures: ['local-floor'] });
      const code = import('./vr_mode');
      const session = await asked;
      session.addEventListener('end', () => (isBusy = false));
      const { VrMode } = await code;
      const mode = new VrMode(session, {
        model: host.model,
        viewer,
        wielded: await carving.begin(),
        color: welcome.color,
        frame: host.frame,
        ended: () => {
          state = () => null;
          carving.leave();
        },
      });
      await mode.begin();
      state = () => mode.state;
    } catch (problem) {
      isBusy = false;
      carving.leave();
      host.say(t('The headset could not start: {0}', (problem as Error).message));
    }
  };
  xr?.isSessionSupported('immersive-vr').then(
    (isSupported) => {
      if (!isSupported) return;
      const button = iconButton(ICONS.headset, t('Enter VR'), '', () => void enter());
      host.toolbar.append(button);
    },
    () => undefined, // forbidden by a policy: as if there were none
  );
  return () => state();
}
