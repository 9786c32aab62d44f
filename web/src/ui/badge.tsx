// SPDX-License-Identifier: Apache-2.0
// The connection badge, which names the state, and the figures of the connection for the details.

import type { ReadonlySignal } from '@preact/signals';
import { t } from '../strings';
import type { SessionModel } from '../model/session';
import { milliseconds } from './format';

const STALE_MS = 1000;

export type BadgeState = SessionModel['status'] | 'stale' | 'silent' | 'past';

/** The badge's label for a session now, and for how long the server has been silent. */
export function badgeOf(
  model: SessionModel,
  nowMs: number,
): { state: BadgeState; label: string; brief: string } {
  if (model.status !== 'connected')
    return { state: model.status, label: LABELS[model.status], brief: '' };
  const { overdueMs } = model.liveness;
  if (overdueMs > 0) {
    const brief = t('for {0} s', Math.floor(overdueMs / 1000));
    return { state: 'silent', label: LABELS.silent, brief };
  }
  const active = model.active(nowMs);
  const staleness = model.stalenessMs(nowMs);
  const isStale = (active && staleness > STALE_MS) || model.lag.isBehind(nowMs);
  const state = model.state?.at ? 'past' : isStale ? 'stale' : 'connected';
  return { state, label: LABELS[state], brief: '' };
}

/** Round trip, frames per second and delay of the view, and a limit if one was asked for. */
export function connectionText(model: SessionModel, nowMs: number): string {
  if (model.status !== 'connected') return '–';
  const delay = milliseconds(model.stalenessMs(nowMs));
  const age = model.active(nowMs) ? t('{0} behind', delay) : t('up to date');
  const roundTrip = milliseconds(model.clock.rttMs);
  const rate = model.frames.perSecond(nowMs);
  return t('Round trip {0} · {1} frames/s · {2}', roundTrip, rate, age) + budgetOf(model);
}

function budgetOf({ welcome }: SessionModel): string {
  if (welcome?.budget === undefined) return '';
  return t(' · up to {0} kB/s', Math.round(welcome.budget / 1000));
}

export function Badge({ model, nowMs }: { model: SessionModel; nowMs: ReadonlySignal<number> }) {
  const { state, label, brief } = badgeOf(model, nowMs.value);
  return (
    <div class="badge" role="status" aria-live="polite" data-state={state}>
      <span class="badge-dot" />
      <span class="badge-state">{label}</span>
      {/* Hidden from screen readers, which announce changes of the state only. */}
      <span class="badge-detail" aria-hidden="true" hidden={brief === ''}>
        {brief}
      </span>
    </div>
  );
}

const LABELS = {
  connecting: t('Connecting'),
  connected: t('Live'),
  past: t('Past'),
  stale: t('Behind'),
  silent: t('No answer'),
  reconnecting: t('Reconnecting'),
  stopped: t('Disconnected'),
} as const;
