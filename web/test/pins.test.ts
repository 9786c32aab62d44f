// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { signal } from '@preact/signals';
import { h, render } from 'preact';
import { beforeEach, describe, expect, it, vi } from 'vitest';
import { SessionModel } from '../src/model/session';
import type { TogetherHost } from '../src/ui/together/host';
import { PinRows } from '../src/ui/together/rows';
import { TogetherSection } from '../src/ui/together/section';
import { TogetherState } from '../src/ui/together/state';
import type { TogetherPanel } from '../src/ui/together/together_panel';
import type { Pin, Welcome } from '../src/wire/types';
import { turn } from './support/turn';

const PIN: Pin = {
  pin: 1,
  text: 'deeper here?',
  at_mm: [1, 2, 0],
  normal: [0, 0, 1],
  author: 'Ada',
  created_ms: 1000,
};

function welcome(may?: string[]): Welcome {
  const plain = { type: 'welcome', participant: 9, participants: [], tools: [] };
  return { ...plain, ...(may ? { may } : {}) } as unknown as Welcome;
}

let model: SessionModel;
let viewer: object | null;
let host: TogetherHost;

beforeEach(() => {
  model = new SessionModel();
  model.apply(welcome());
  viewer = {};
  const picture = {
    get viewer() {
      return viewer;
    },
  };
  const shell = { isAiming: signal(false) };
  host = { model, session: 'wall', name: () => 'Ada', picture, shell } as unknown as TogetherHost;
});

describe('the list of pins', () => {
  const lookAt = vi.fn();
  const remove = vi.fn();
  let list: HTMLElement;

  beforeEach(() => {
    vi.clearAllMocks();
    list = document.createElement('ul');
    render(h(PinRows, { host, lookAt, remove }), list);
  });

  async function show(...pins: Pin[]): Promise<string[]> {
    model.apply({ type: 'pins', pins });
    await turn();
    return [...list.children].map(({ textContent }) => textContent);
  }

  it('follows the pins of the session', async () => {
    expect(await show(PIN, { ...PIN, pin: 2, text: 'too deep', author: 'Bo' })).toEqual([
      'deeper here?AdaRemove',
      'too deepBoRemove',
    ]);
    expect(await show({ ...PIN, pin: 2, text: 'too deep', author: 'Bo' })).toHaveLength(1);
    model.apply(welcome());
    await turn();
    expect(list.children).toHaveLength(0);
  });

  it('looks at a pin and removes it', async () => {
    await show(PIN);
    list.querySelector<HTMLElement>('.pin-go')!.click();
    list.querySelector<HTMLElement>('.quiet-action')!.click();
    expect(lookAt).toHaveBeenCalledWith(PIN);
    expect(remove).toHaveBeenCalledWith(PIN);
  });

  it('offers to remove the pins that the viewer may remove', async () => {
    const foreign = { ...PIN, pin: 2, author: 'Bo' };
    const removable = (): string[] =>
      [...list.querySelectorAll('.quiet-action')].map(
        (button) => button.parentElement!.querySelector('small')!.textContent,
      );
    model.apply(welcome([]));
    await show(PIN, foreign);
    expect(removable()).toEqual([]);
    model.apply(welcome(['place_pins']));
    await show(PIN, foreign);
    expect(removable()).toEqual(['Ada']);
    model.apply(welcome(['moderate']));
    await show(PIN, foreign);
    expect(removable()).toEqual(['Ada', 'Bo']);
  });
});

describe('the buttons of the section', () => {
  const press = vi.fn();
  let state: TogetherState;
  let section: HTMLElement;

  function open(): void {
    vi.clearAllMocks();
    state = new TogetherState();
    section = document.createElement('section');
    const panel = signal<TogetherPanel | null>(null);
    render(h(TogetherSection, { host, state, panel, press }), section);
  }
  const buttons = (): HTMLButtonElement[] => [...section.querySelectorAll('button')];

  it('are disabled without a picture', () => {
    viewer = null;
    open();
    for (const button of buttons()) {
      expect(button.getAttribute('aria-disabled')).toBe('true');
      button.click();
    }
    expect(press).not.toHaveBeenCalled();
  });

  it('say which of them is on', async () => {
    open();
    const [pin, share, picture, video] = buttons() as [
      HTMLButtonElement,
      HTMLButtonElement,
      HTMLButtonElement,
      HTMLButtonElement,
    ];
    for (const button of [pin, share, picture, video]) button.click();
    expect(press.mock.calls.flat()).toEqual(['setPin', 'share', 'savePicture', 'saveVideo']);
    host.shell.isAiming.value = true;
    state.isShared.value = true;
    state.recorded.value = 0.25;
    await turn();
    expect(pin.getAttribute('aria-pressed')).toBe('true');
    expect(share.getAttribute('aria-pressed')).toBe('true');
    expect(video.textContent).toBe('Cancel video, 25 %');
    state.recorded.value = null;
    await turn();
    expect(video.textContent).toBe('Save video');
  });

  it('hide the pin from a viewer who may not set one', async () => {
    open();
    expect(buttons()[0]!.hidden).toBe(false);
    model.apply(welcome([]));
    await turn();
    expect(buttons()[0]!.hidden).toBe(true);
  });
});
