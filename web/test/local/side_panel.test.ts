// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { NO_FILES } from '../../src/local/given_files';
import type { About, Progress } from '../../src/local/program_block';
import { SidePanel } from '../../src/local/side_panel';
import type { SideActions } from '../../src/local/side_panel';
import type { FakeElement } from '../support/fake_dom';
import { stubPage } from '../support/fake_dom';
import { fakeMouse } from '../support/fake_space_mouse';

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
    stubPage();
    frames = [];
    stored = new Map();
    Object.assign(document, { hasFocus: () => true });
    vi.stubGlobal('localStorage', {
      getItem: (key: string) => stored.get(key) ?? null,
      setItem: (key: string, value: string) => stored.set(key, value),
    });
    vi.stubGlobal('requestAnimationFrame', (act: (nowMs: number) => void) => frames.push(act));
  });
  afterEach(() => vi.unstubAllGlobals());

  /** Makes a panel that records the moves of its 3D mouse in `moves`. */
  function make(isBusy: () => boolean): {
    preferences: FakeElement;
    moves: string[];
    panel: SidePanel;
  } {
    const moves: string[] = [];
    const note =
      (name: string) =>
      (...values: number[]): void => {
        if (name === 'pan') moves.push(`${name} ${values.map((v) => v.toFixed(3)).join(' ')}`);
      };
    const rig = { orbit: note('orbit'), pan: note('pan'), zoom: note('zoom'), fit: note('fit') };
    const capMouse = { rig: () => rig, isBusy, say: () => undefined };
    const none = (): undefined => undefined;
    const actions: SideActions = {
      ...{ choose: none, remove: none, stop: none, seek: none, play: none, takeHome: none },
      ...{ save: none, linePressed: none, materialChosen: none, layoutChanged: none },
      capMouse,
    };
    const panel = new SidePanel(actions);
    const element = panel.element as unknown as FakeElement;
    return { preferences: element.all('preferences')[0]!, moves, panel };
  }

  function frame(nowMs: number): void {
    for (const act of frames.splice(0)) act(nowMs);
  }

  it('has a 3D mouse move the picture, but not while a tool is in hand', async () => {
    const mouse = fakeMouse();
    vi.stubGlobal('navigator', { hid: mouse.hid, language: 'en' });
    stored.set('kerf.space-mouse', 'block');
    let isBusy = false;
    const { preferences, moves } = make(() => isBusy);
    const [button] = preferences.all('quiet-action');
    expect(button!.textContent).toBe('3D mouse');
    const isOn = (): void => expect(button!.getAttribute('aria-pressed')).toBe('true');
    await vi.waitFor(isOn, { timeout: 30_000 });
    frame(1000);
    // Recorded: the cap of a SpaceMouse pushed to the right.
    mouse.report(1, 0x5e, 0x01, 0x00, 0x00, 0x00, 0x00, 0, 0, 0, 0, 0, 0);
    frame(1020);
    isBusy = true;
    frame(1040);
    expect(moves.filter((move) => move !== 'pan 0.000 0.000')).toEqual(['pan -0.020 0.000']);
  });

  it('no longer says that files are read when they are of no use', () => {
    vi.stubGlobal('navigator', { language: 'en' });
    const { panel } = make(() => false);
    const text = (): string => (panel.element as unknown as FakeElement).textContent;
    panel.setStatus('reading');
    expect(text()).toContain('Reading…');
    panel.setStatus('failed');
    expect(text()).not.toContain('Reading…');
  });

  it('says of other files nothing that was verified of the ones before', () => {
    vi.stubGlobal('navigator', { language: 'en' });
    const { panel } = make(() => false);
    const text = (): string => (panel.element as unknown as FakeElement).textContent;
    panel.setStored('Verified up to step 9');
    expect(text()).toContain('Verified');
    panel.setFiles(NO_FILES, null);
    expect(text()).not.toContain('Verified');
  });

  it('counts the motions of a program, and the steps of a journal', () => {
    vi.stubGlobal('navigator', { language: 'en' });
    const { panel } = make(() => false);
    const text = (): string => (panel.element as unknown as FakeElement).textContent;
    panel.setFiles(NO_FILES, null);
    panel.setAbout(ABOUT);
    panel.setProgress(PROGRESS, 12, true);
    expect(text()).toContain('Motions5');
    expect(text()).toContain('Step 2 of 5');
    panel.setAbout({ ...ABOUT, kernel_version: 9 });
    panel.setProgress(PROGRESS, 12, true);
    expect(text()).toContain('Steps5');
    expect(text()).toContain('Step 2 of 5');
  });

  it('has no 3D mouse where the browser can have none', () => {
    vi.stubGlobal('navigator', { language: 'en' });
    expect(make(() => false).preferences.all('quiet-action')).toEqual([]);
  });
});
