// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { CarveHost } from '../../src/carve/host';
import { forgetStrokes, keepStrokes } from '../../src/local/autosave';
import { download } from '../../src/local/download';
import { LocalHand } from '../../src/local/hand';
import type { HandHost } from '../../src/local/hand';
import { writeKerfFile } from '../../src/local/kerf_file_writer';
import type { FromWorker, ToWorker } from '../../src/local/messages';
import type { JournalParts } from '../../src/local/program_block';
import { SessionModel } from '../../src/model/session';
import type { Welcome } from '../../src/wire/types';

const mounted = vi.hoisted(() => ({ host: null as CarveHost | null, toggle: vi.fn() }));
vi.mock('../../src/carve/part', () => ({
  CarvePart: class {
    readonly action = { name: 'carve' };
    readonly toggle = mounted.toggle;
    readonly isActive = false;
    readonly isBusy = false;
    readonly vrState = null;
    constructor(host: CarveHost) {
      mounted.host = host;
    }
  },
}));
vi.mock('../../src/local/autosave', () => ({
  keepStrokes: vi.fn(() => Promise.resolve()),
  forgetStrokes: vi.fn(() => Promise.resolve()),
}));
vi.mock('../../src/local/download', () => ({ download: vi.fn() }));
vi.mock('../../src/local/kerf_file_writer', () => ({ writeKerfFile: vi.fn() }));

const FILE = new Uint8Array([1, 2, 3]);
const PARTS = { id: new TextEncoder().encode('wave') } as JournalParts;
const CHANGED: FromWorker = { type: 'changed', undone: true, reason: '' };

describe('strokes by hand in a page without a server', () => {
  let posted: ToWorker[];
  let said: string[];
  let whyNot: string;
  let asks: (event: { preventDefault: () => void }) => void;
  const confirm = vi.fn<(question: string) => boolean>();
  let model: SessionModel;
  let hand: LocalHand;

  beforeEach(() => {
    vi.useFakeTimers();
    vi.clearAllMocks();
    vi.mocked(writeKerfFile).mockResolvedValue(FILE);
    vi.spyOn(console, 'warn').mockImplementation(() => undefined);
    [posted, said, whyNot] = [[], [], ''];
    vi.stubGlobal('window', {
      confirm,
      addEventListener: (_name: string, listener: typeof asks) => (asks = listener),
    });
    model = new SessionModel();
    const welcome = { type: 'welcome', color: '#112233', participants: [], tools: [] };
    model.apply(welcome as unknown as Welcome);
    hand = new LocalHand({
      model,
      post: (message: ToWorker) => posted.push(message),
      whyNot: () => whyNot,
      file: () => null,
      say: (text: string) => said.push(text),
    } as unknown as HandHost);
  });
  afterEach(() => {
    vi.useRealTimers();
    vi.unstubAllGlobals();
    vi.restoreAllMocks();
  });

  /** Whether the browser would ask before it closes the page. */
  function asksAtClosing(): boolean {
    const preventDefault = vi.fn();
    asks({ preventDefault });
    return preventDefault.mock.calls.length > 0;
  }
  const saves = (): number => posted.filter(({ type }) => type === 'save').length;
  async function written(): Promise<void> {
    hand.heard({ type: 'saved', parts: PARTS });
    await vi.advanceTimersByTimeAsync(0);
  }

  it('may go while there are none', () => {
    expect([hand.mayGo(), asksAtClosing()]).toEqual([true, false]);
    expect(confirm).not.toHaveBeenCalled();
  });

  it('go only if the user says so, and then are forgotten', () => {
    hand.heard(CHANGED);
    expect(asksAtClosing()).toBe(true);
    confirm.mockReturnValue(false);
    expect(hand.mayGo()).toBe(false);
    expect(confirm.mock.calls[0]![0]).toMatch(/^Unsaved strokes/);
    expect(forgetStrokes).not.toHaveBeenCalled();
    confirm.mockReturnValue(true);
    expect(hand.mayGo()).toBe(true);
    expect(forgetStrokes).toHaveBeenCalledOnce();
  });

  it('are kept in the browser every three seconds while there are more', async () => {
    for (let n = 0; n < 5; ++n) hand.heard(CHANGED);
    await vi.advanceTimersByTimeAsync(2900);
    expect(saves()).toBe(0);
    await vi.advanceTimersByTimeAsync(200);
    expect(saves()).toBe(1);
    await written();
    expect(keepStrokes).toHaveBeenCalledWith(
      expect.objectContaining({ name: 'wave.kerf', bytes: FILE }),
    );
    await vi.advanceTimersByTimeAsync(60_000);
    expect(saves()).toBe(1);
    hand.heard(CHANGED);
    await vi.advanceTimersByTimeAsync(3000);
    expect(saves()).toBe(2);
    expect(asksAtClosing()).toBe(true);
    expect(download).not.toHaveBeenCalled();
  });

  it('may go, and are forgotten by the browser, once they are in a file', async () => {
    hand.heard(CHANGED);
    hand.save();
    await written();
    expect(download).toHaveBeenCalledWith('wave.kerf', FILE);
    expect([hand.mayGo(), asksAtClosing()]).toEqual([true, false]);
    expect(forgetStrokes).toHaveBeenCalledOnce();
    await vi.advanceTimersByTimeAsync(10_000);
    expect([saves(), vi.mocked(keepStrokes).mock.calls.length]).toEqual([1, 0]);
  });

  it('stay unsaved where the file cannot be written, and the user hears why', async () => {
    vi.mocked(writeKerfFile).mockRejectedValue(new Error('no memory'));
    hand.heard(CHANGED);
    hand.save();
    await written();
    expect(said).toEqual(['The file could not be saved: no memory']);
    expect(asksAtClosing()).toBe(true);
  });

  it('belong to the block that is gone', async () => {
    hand.heard(CHANGED);
    hand.reset([]);
    expect([hand.mayGo(), asksAtClosing()]).toEqual([true, false]);
    await vi.advanceTimersByTimeAsync(10_000);
    expect(saves()).toBe(0);
  });

  it('are of a participant that no other one of the block is', () => {
    const others = [
      { participant: 1, name: 'wave.ngc', color: '#445566', tool: 0, kind: 'program' },
      { participant: 4, name: 'Ada', color: '#778899', tool: 0, kind: 'agent' },
    ] as const;
    hand.reset([...others]);
    const link = mounted.host!.linkHere!({
      ...{ status: vi.fn(), joined: vi.fn(), result: vi.fn(), rejected: vi.fn() },
      changed: vi.fn(),
    });
    link.join();
    expect(posted).toEqual([expect.objectContaining({ type: 'hand', participant: 5 })]);
    hand.heard({ type: 'handed', about: { tools: [] } } as unknown as FromWorker);
    expect(model.participants.all().map(({ info }) => [info.participant, info.name])).toEqual([
      [1, 'wave.ngc'],
      [4, 'Ada'],
      [5, 'You'],
    ]);
  });

  it('begin only where something can be carved', () => {
    whyNot = 'There is no block.';
    hand.toggle();
    expect([said, mounted.toggle.mock.calls.length]).toEqual([['There is no block.'], 0]);
    whyNot = '';
    hand.toggle();
    expect(mounted.toggle).toHaveBeenCalledOnce();
  });
});
