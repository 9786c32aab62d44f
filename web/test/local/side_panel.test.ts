// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { signal } from '@preact/signals';
import { h } from 'preact';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { About, Progress } from '../../src/local/program_block';
import { SidePanel } from '../../src/local/side_panel';
import { LocalState } from '../../src/local/state';
import { SessionModel } from '../../src/model/session';
import type { Picture } from '../../src/ui/picture';
import { TextState } from '../../src/ui/programs/text_state';
import { Transport } from '../../src/ui/timeline/transport';
import { fakeMouse } from '../support/fake_space_mouse';
import { emptyShell } from '../support/shown';
import { turn } from '../support/turn';

const ABOUT: About = {
  ...{ name: 'Bowl', rays: 'dexel', pitch_mm: 0.2, tolerance_mm: 0.01, pivot_mm: 20 },
  ...{ motions: 5, lines: 0, machining_s: 3, notes: [], warnings: [], tools: [] },
  stock: { shape: 'box', min_mm: [0, 0, -9], max_mm: [9, 9, 0] },
  grid: { origin_mm: [0, 0, -9], columns: [45, 45], tile: 32 },
};
const PROGRESS: Progress = {
  ...{ carved: 2, machining_s: 1, time_s: 1, next_s: 2, removed_mm3: 3, line: 0 },
};

describe('the panel of the page without a server', () => {
  let frames: ((nowMs: number) => void)[];
  let stored: Map<string, string>;

  beforeEach(() => {
    frames = [];
    stored = new Map();
    vi.spyOn(document, 'hasFocus').mockReturnValue(true);
    vi.stubGlobal('navigator', { language: 'en' });
    vi.stubGlobal('localStorage', {
      getItem: (key: string) => stored.get(key) ?? null,
      setItem: (key: string, value: string) => stored.set(key, value),
    });
    vi.stubGlobal('requestAnimationFrame', (act: (nowMs: number) => void) => frames.push(act));
  });
  afterEach(() => {
    vi.unstubAllGlobals();
    vi.restoreAllMocks();
  });

  /** Shows a panel that records the moves of its 3D mouse in `moves`. */
  function make(isBusy = (): boolean => false) {
    const moves: string[] = [];
    const note =
      (name: string) =>
      (...values: number[]): void => {
        if (name === 'pan') moves.push(`${name} ${values.map((v) => v.toFixed(3)).join(' ')}`);
      };
    const rig = { orbit: note('orbit'), pan: note('pan'), zoom: note('zoom'), fit: note('fit') };
    const none = (): undefined => undefined;
    const state = new LocalState();
    const shell = emptyShell();
    const panel = h(SidePanel, {
      ...{ shell, state, text: new TextState(), path: signal(null) },
      transport: new Transport({ step: none, play: none }),
      participants: new SessionModel().participants,
      picture: { setMaterial: none } as unknown as Picture,
      capMouse: { rig: () => rig, isBusy, say: none },
      actions: {
        ...{
          example: vi.fn(),
          newBlock: vi.fn(),
          choose: none,
          remove: none,
          stop: none,
          seek: none,
          takeHome: none,
        },
        ...{ save: none, linePressed: none },
      },
    });
    shell.show(null, panel);
    const text = async (): Promise<string> => {
      await turn();
      return document.body.textContent;
    };
    const mouse = (): HTMLElement | null =>
      document.querySelector<HTMLElement>('.preferences button.quiet-action');
    return { state, moves, text, mouse };
  }

  function frame(nowMs: number): void {
    for (const act of frames.splice(0)) act(nowMs);
  }

  it('has a 3D mouse move the picture, but not while a tool is in hand', async () => {
    const device = fakeMouse();
    vi.stubGlobal('navigator', { hid: device.hid, language: 'en' });
    stored.set('kerf.space-mouse', 'block');
    let isBusy = false;
    const { mouse, moves } = make(() => isBusy);
    expect(mouse()!.textContent).toBe('3D mouse');
    const isOn = (): void => expect(mouse()!.getAttribute('aria-pressed')).toBe('true');
    await vi.waitFor(isOn, { timeout: 30_000 });
    frame(1000);
    // Recorded: the cap of a SpaceMouse pushed to the right.
    device.report(1, 0x5e, 0x01, 0x00, 0x00, 0x00, 0x00, 0, 0, 0, 0, 0, 0);
    frame(1020);
    isBusy = true;
    frame(1040);
    expect(moves.filter((move) => move !== 'pan 0.000 0.000')).toEqual(['pan -0.020 0.000']);
  });

  it('no longer says that files are read when they are of no use', async () => {
    const { state, text } = make();
    state.status.value = 'reading';
    expect(await text()).toContain('Reading…');
    state.status.value = 'failed';
    expect(await text()).not.toContain('Reading…');
  });

  it('says of other files nothing that was verified of the ones before', async () => {
    const { state, text } = make();
    state.stored.value = 'Verified up to step 9';
    expect(await text()).toContain('Verified');
    state.begin();
    expect(await text()).not.toContain('Verified');
  });

  it('counts the motions of a program, and the steps of a journal', async () => {
    const { state, text } = make();
    state.about.value = ABOUT;
    state.progress.value = PROGRESS;
    expect(await text()).toContain('Motions5');
    expect(await text()).toContain('Step 2 of 5');
    state.about.value = { ...ABOUT, kernel_version: 9 };
    expect(await text()).toContain('Steps5');
    expect(await text()).toContain('Step 2 of 5');
  });

  it('has no 3D mouse where the browser can have none', () => {
    expect(make().mouse()).toBeNull();
  });
});
