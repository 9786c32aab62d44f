// SPDX-License-Identifier: Apache-2.0
// The lists of the section: shared views as chips, and pins.

import { t } from '../../strings';
import type { Pin } from '../../wire/types';
import type { TogetherHost } from './host';
import type { SharedViews } from './shared_views';

export function CameraRows({ views }: { views: SharedViews }) {
  return views.offered.map((camera) => {
    const isFollowed = camera.participant === views.followed;
    return (
      <li key={camera.participant}>
        <button
          type="button"
          class="chip view-chip"
          style={`--who:${camera.color}`}
          aria-pressed={isFollowed}
          onClick={() => views.follow(isFollowed ? null : camera)}
        >
          {isFollowed ? t('Following {0}', camera.name) : t('Follow {0}', camera.name)}
        </button>
      </li>
    );
  });
}

interface PinRowsProps {
  host: TogetherHost;
  lookAt: (pin: Pin) => void;
  remove: (pin: Pin) => void;
}

export function PinRows({ host, lookAt, remove }: PinRowsProps) {
  const { together, welcome } = host.model;
  const may = (action: string): boolean =>
    welcome?.may === undefined || welcome.may.includes(action);
  return together.pins.map((pin) => {
    const isOwn = pin.author === host.name();
    return (
      <li class="pin" key={pin.pin}>
        <button
          type="button"
          class="pin-go"
          title={t('Look at this spot')}
          onClick={() => lookAt(pin)}
        >
          <span class="pin-words">{pin.text}</span>
          <small>{pin.author}</small>
        </button>
        {(may('moderate') || (isOwn && may('place_pins'))) && (
          <button
            type="button"
            class="quiet-action"
            aria-label={t('Remove the pin “{0}”', pin.text)}
            onClick={() => remove(pin)}
          >
            {t('Remove')}
          </button>
        )}
      </li>
    );
  });
}
