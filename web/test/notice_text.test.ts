// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { SessionModel } from '../src/model/session';
import { Flash, noticeText } from '../src/ui/notice_text';
import type { NoticeState } from '../src/ui/notice_text';
import type { StateMessage } from '../src/wire/types';

describe('the notice over the picture', () => {
  let model: SessionModel;
  let state: NoticeState;

  beforeEach(() => {
    vi.useFakeTimers();
    model = new SessionModel();
    state = { model, retryAtMs: null, contextLost: false, hasNoPicture: false, flash: new Flash() };
  });
  afterEach(() => vi.useRealTimers());

  const text = (): string => noticeText(state, performance.now()).text;

  it('says that the page connects, then that the block loads', () => {
    expect(text()).toBe('Connecting…');
    model.setStatus('connected', '');
    expect(text()).toBe('Loading the block…');
  });

  it('counts down to the next attempt, and offers it at once', () => {
    model.setStatus('reconnecting', 'the server restarts');
    state.retryAtMs = performance.now() + 1500;
    expect(noticeText(state, performance.now())).toEqual({
      text: 'The server restarts.',
      wait: 'Reconnecting in 2 s',
      action: 'Now',
    });
    vi.advanceTimersByTime(1400);
    expect(noticeText(state, performance.now()).wait).toBe('Reconnecting in 1 s');
    state.retryAtMs = null;
    expect(noticeText(state, performance.now())).toEqual({
      text: 'The server restarts. Reconnecting…',
    });
  });

  it('says why a connection has ended for good', () => {
    model.setStatus('stopped', '');
    expect(text()).toBe('The server closed the session. You see the last state.');
    model.setStatus('stopped', 'you were removed');
    expect(text()).toBe('You were removed. You see the last state.');
  });

  it('shows a sentence for a short time, before lasting states', () => {
    model.setStatus('connected', '');
    state.hasNoPicture = true;
    state.flash.say('Your stroke was redone.');
    expect(text()).toBe('Your stroke was redone.');
    vi.advanceTimersByTime(2600);
    expect(text()).toMatch(/^No 3D view/);
    state.contextLost = true;
    expect(text()).toMatch(/^The graphics card/);
  });

  it('says that the session is paused', () => {
    model.setStatus('connected', '');
    model.apply({ type: 'state', paused: 'lease' } as StateMessage);
    expect(text()).toBe("Carving is paused: the servers can't reach each other.");
    model.apply({ type: 'state', paused: 'disk' } as StateMessage);
    expect(text()).toMatch(/^Carving is paused: the server's disk is full/);
  });
});
