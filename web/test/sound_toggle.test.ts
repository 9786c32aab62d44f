// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { soundOf } from '../src/model/sound';
import { SoundToggle } from '../src/ui/sound';
import type { SoundOutput } from '../src/view/sound_output';

/** As much of a button as the toggle uses; there is no page in these tests. */
class FakeElement {
  private readonly attributes_ = new Map<string, string>();
  private click_ = (): void => undefined;
  innerHTML = '';

  readonly append = (): void => undefined;
  setAttribute(name: string, value: string): void {
    this.attributes_.set(name, value);
  }
  getAttribute(name: string): string | null {
    return this.attributes_.get(name) ?? null;
  }
  addEventListener(_name: string, action: () => void): void {
    this.click_ = action;
  }
  click(): void {
    this.click_();
  }
}

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

function toggleWith(output: () => Promise<SoundOutput>): SoundToggle {
  return new SoundToggle(() => soundOf(null), output);
}

function pressed(toggle: SoundToggle): string | null {
  return toggle.button.getAttribute('aria-pressed');
}

describe('the button for sound', () => {
  beforeEach(() => {
    FakeContext.missing = false;
    FakeContext.created = [];
    vi.useFakeTimers();
    vi.stubGlobal('AudioContext', FakeContext);
    vi.stubGlobal('document', {
      hidden: false,
      createElement: () => new FakeElement(),
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
    toggle.button.click();
    await vi.advanceTimersByTimeAsync(200);
    expect([pressed(toggle), toggle.state?.context]).toEqual(['true', 'running']);
    const calls = OUTPUT.set.mock.calls.length;
    expect(calls).toBeGreaterThan(0);
    toggle.button.click();
    await vi.advanceTimersByTimeAsync(200);
    expect([pressed(toggle), toggle.state?.context]).toEqual(['false', 'suspended']);
    expect(OUTPUT.set.mock.calls.length).toBe(calls);
  });

  it('stays off without an audio device, and tries again', async () => {
    FakeContext.missing = true;
    const toggle = toggleWith(create);
    expect(() => toggle.button.click()).not.toThrow();
    expect(() => toggle.button.click()).not.toThrow();
    expect(pressed(toggle)).toBe('false');
    FakeContext.missing = false;
    toggle.button.click();
    await vi.advanceTimersByTimeAsync(200);
    expect([pressed(toggle), toggle.state?.context]).toEqual(['true', 'running']);
  });

  it('turns off if its code does not load, and loads it again', async () => {
    // vitest fails on a rejection that nothing handles.
    const load = vi.fn(create).mockRejectedValueOnce(new Error('offline'));
    const toggle = toggleWith(load);
    toggle.button.click();
    await vi.advanceTimersByTimeAsync(200);
    expect([pressed(toggle), toggle.state]).toEqual(['false', null]);
    expect(FakeContext.created.map((c) => c.state)).toEqual(['closed']);
    toggle.button.click();
    await vi.advanceTimersByTimeAsync(200);
    expect(load).toHaveBeenCalledTimes(2);
    expect([pressed(toggle), toggle.state?.context]).toEqual(['true', 'running']);
  });
});
