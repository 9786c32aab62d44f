// SPDX-License-Identifier: Apache-2.0
// The button that begins to carve. All else of it is a chunk of its own.

import { t } from '../strings';
import { iconButton } from '../ui/dom';
import { ICONS } from '../ui/icons';
import type { CarveMode } from './carve_mode';
import type { CarveHost } from './host';
import { whyNotCarve } from './reasons';
import { mountVr } from './vr/mount';
import type { VrState } from './vr/vr_mode';

export interface CarveSwitch {
  toggle: () => void;
  isActive: () => boolean;
  /** Whether something of the path is still drawn, sent or not answered. */
  isBusy: () => boolean;
  /** Shows whether this viewer may carve. */
  update: () => void;
  /** The hash of the page's copy of the block; null: it has none. */
  copyHash: () => Promise<string | null> | null;
  /** The state of the headset; null without one. */
  vr: () => VrState | null;
}

const LABEL = t('Carve');
const KEY = 'C';

/** Adds the button to the toolbar. */
export function mountCarve(host: CarveHost): CarveSwitch {
  let mode: CarveMode | null = null;
  let loading: Promise<CarveMode | null> | null = null;
  const whyNot = (): string => {
    const { welcome } = host.model;
    if (!welcome) return t('The session is still loading.');
    const reason = whyNotCarve(welcome);
    const hasPicture = host.picture.viewer !== null;
    return reason !== '' || hasPicture ? reason : t('The view is still loading.');
  };
  const toggle = (): void => {
    if (mode?.isActive) {
      mode.leave();
      return;
    }
    const reason = whyNot();
    if (reason !== '') {
      host.say(reason);
      return;
    }
    void load().then((one) => {
      host.begins();
      one?.enter();
    });
  };
  const load = (): Promise<CarveMode | null> =>
    (loading ??= import('./carve_mode').then(
      ({ CarveMode }) => (mode = new CarveMode(host, host.picture.viewer!, button)),
      (problem: unknown) => {
        loading = null; // the next press tries again
        console.warn('Carving did not load:', problem);
        return null;
      },
    ));
  const button = iconButton(ICONS.carve, LABEL, KEY, toggle);
  button.setAttribute('aria-pressed', 'false');
  host.toolbar.prepend(button);
  const update = (): void => {
    const reason = whyNot();
    const title = reason === '' ? `${LABEL} (${KEY})` : `${LABEL}: ${reason}`;
    if (button.title === title) return;
    button.title = title;
    button.setAttribute('aria-disabled', String(reason !== ''));
    button.setAttribute('aria-description', reason);
  };
  let hasBegun = false;
  const vr = mountVr(host, {
    begin: async () => {
      const carving = whyNot() === '' ? await load() : null;
      hasBegun = carving?.isActive === false;
      host.begins();
      carving?.enter();
      return carving?.wielded ?? null;
    },
    leave: () => {
      if (hasBegun) mode?.leave();
      hasBegun = false;
    },
  });
  const isActive = (): boolean => mode?.isActive ?? false;
  const isBusy = (): boolean => mode?.isBusy ?? false;
  return { toggle, isActive, isBusy, update, copyHash: () => mode?.copyHash() ?? null, vr };
}
