// SPDX-License-Identifier: Apache-2.0
// The text of the notice over the picture: the most important problem or event.

import { t } from '../strings';
import type { SessionModel } from '../model/session';
import { pauseText, sentence } from './format';
import type { NoticeText } from './notice';

export const SESSION_CLOSED = t('The server closed the session');
const NO_PICTURE = t(
  'No 3D view: this browser has no WebGL 2. Turn on hardware acceleration to see the block. Everything else works.',
);
const FLASH_MS = 2500;

/** A sentence that is shown for a short time. */
export class Flash {
  private text_ = '';
  private untilMs_ = 0;

  say(text: string): void {
    this.text_ = text;
    this.untilMs_ = performance.now() + FLASH_MS;
  }

  /** Empty: none now. */
  text(nowMs: number): string {
    return nowMs < this.untilMs_ ? this.text_ : '';
  }
}

export interface NoticeState {
  model: SessionModel;
  /** When the next attempt to connect begins; null: none waits. */
  retryAtMs: number | null;
  contextLost: boolean;
  hasNoPicture: boolean;
  flash: Flash;
}

function reconnecting({ model, retryAtMs }: NoticeState, nowMs: number): NoticeText {
  const text = sentence(model.statusReason || t('The connection was lost'));
  if (retryAtMs === null) return { text: t('{0} Reconnecting…', text) };
  const seconds = Math.max(1, Math.ceil((retryAtMs - nowMs) / 1000));
  return { text, wait: t('Reconnecting in {0} s', seconds), action: t('Now') };
}

export function noticeText(state: NoticeState, nowMs: number): NoticeText {
  const { status, statusReason, tiles } = state.model;
  if (status === 'reconnecting') return reconnecting(state, nowMs);
  if (status === 'stopped')
    return {
      text: t('{0} You see the last state.', sentence(statusReason || SESSION_CLOSED)),
    };
  if (status === 'connecting') return { text: t('Connecting…') };
  if (state.contextLost)
    return {
      text: t(
        'The graphics card stopped responding. The view returns when the browser has restored it.',
      ),
    };
  const flash = state.flash.text(nowMs);
  if (flash !== '') return { text: flash };
  const paused = pauseText(state.model.state);
  if (paused !== '') return { text: paused };
  if (state.hasNoPicture) return { text: NO_PICTURE };
  return { text: tiles.complete ? '' : t('Loading the block…') };
}
