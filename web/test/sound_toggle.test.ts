// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { soundOf } from '../src/model/sound';
import { Sound } from '../src/ui/sound';
import type { SoundOutput } from '../src/view/sound_output';

/** An audio device that may be missing. */
class FakeContext {
  static missing = false;
  static created: FakeContext[] = [];
  state: AudioContextState = 'suspended';

  constructor() {
    if (FakeContext.missing) throw new DOMException('no device', 'NotSupportedError');
    FakeContext.created.push(this);
  }
  private become_(state: AudioContextState): Promise<void> {
    if (this.state === 'closed') return Promise.reject(new Error('closed'));
    this.state = state;
    return Promise.resolve();
  }
  resume(): Promise<void> {
    return this.become_('running');
  }
  suspend(): Promise<void> {
    return this.become_('suspended');
  }
  close(): Promise<void> {
    return this.become_('closed');
  }
}

const OUTPUT = { set: vi.fn(), gains: { tone: 0, noise: 0, loudest: 0 } };

function create(): Promise<SoundOutput> {
  return Promise.resolve(OUTPUT as unknown as SoundOutput);
}

function toggleWith(output: () => Promise<SoundOutput>): Sound {
  return new Sound(() => soundOf(null), output);
}

function pressed(toggle: Sound): boolean | undefined {
  return toggle.action.isPressed?.();
}

describe('the action for sound', () => {
  beforeEach(() => {
    FakeContext.missing = false;
    FakeContext.created = [];
    vi.useFakeTimers();
    vi.stubGlobal('AudioContext', FakeContext);
    vi.stubGlobal('document', {
      hidden: false,
      addEventListener: () => undefined,
    });
    vi.spyOn(console, 'warn').mockImplementation(() => undefined);
    OUTPUT.set.mockClear();
  });
  afterEach(() => {
    vi.useRealTimers();
    vi.unstubAllGlobals();
    vi.restoreAllMocks();
  });

  it('plays while it is pressed', async () => {
    const toggle = toggleWith(create);
    toggle.toggle();
    await vi.advanceTimersByTimeAsync(200);
    expect([pressed(toggle), toggle.state?.context]).toEqual([true, 'running']);
    const calls = OUTPUT.set.mock.calls.length;
    expect(calls).toBeGreaterThan(0);
    toggle.toggle();
    await vi.advanceTimersByTimeAsync(200);
    expect([pressed(toggle), toggle.state?.context]).toEqual([false, 'suspended']);
    expect(OUTPUT.set.mock.calls.length).toBe(calls);
  });

  it('stays off without an audio device, and tries again', async () => {
    FakeContext.missing = true;
    const toggle = toggleWith(create);
    expect(() => toggle.toggle()).not.toThrow();
    expect(() => toggle.toggle()).not.toThrow();
    expect(pressed(toggle)).toBe(false);
    FakeContext.missing = false;
    toggle.toggle();
    await vi.advanceTimersByTimeAsync(200);
    expect([pressed(toggle), toggle.state?.context]).toEqual([true, 'running']);
  });

  it('turns off if its code does not load, and loads it again', async () => {
    // vitest fails on a rejection that nothing handles.
    const load = vi.fn(create).mockRejectedValueOnce(new Error('offline'));
    const toggle = toggleWith(load);
    toggle.toggle();
    await vi.advanceTimersByTimeAsync(200);
    expect([pressed(toggle), toggle.state]).toEqual([false, null]);
    expect(FakeContext.created.map((c) => c.state)).toEqual(['closed']);
    toggle.toggle();
    await vi.advanceTimersByTimeAsync(200);
    expect(load).toHaveBeenCalledTimes(2);
    expect([pressed(toggle), toggle.state?.context]).toEqual([true, 'running']);
  });
});
