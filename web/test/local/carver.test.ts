// SPDX-License-Identifier: Apache-2.0
import { beforeEach, describe, expect, it, vi } from 'vitest';
import { Carver } from '../../src/local/carver';
import { NO_FILES } from '../../src/local/given_files';
import type { FromWorker } from '../../src/local/messages';
import type { About, ProgramBlock, Progress } from '../../src/local/program_block';

const MOTIONS = 1000;
const MOTION_MS = 2;
const PAUSE_S = 3600;
const MODULE = {} as WebAssembly.Module;

/** A block whose motions take their time on the clock of the test. */
class FakeBlock {
  carved = 0;
  fault = '';
  faultAt = Infinity;
  dirty = 0;
  motions = MOTIONS;
  isJournal = false;
  constructor(private readonly clock: { ms: number }) {}

  read(): void {
    if (this.fault !== '' && this.faultAt < 0) throw new Error(this.fault);
  }
  make(): void {
    this.carved = 0;
  }
  about(): Partial<About> {
    const version = this.isJournal ? { kernel_version: 1 } : {};
    return { motions: this.motions, ...version };
  }
  path(): unknown {
    return {};
  }
  carve(motions: number): void {
    if (this.carved + motions > this.faultAt) {
      this.carved = this.faultAt;
      throw new Error(this.fault);
    }
    this.carved += motions;
    this.dirty += motions;
    this.clock.ms += motions * MOTION_MS;
  }
  seek(motion: number): void {
    if (motion < this.carved) this.carved = motion - (motion % 100);
  }
  readJournal(): void {
    this.read();
  }
  addRecords(): void {
    this.motions += 100;
  }
  /** A step each 10 ms of its clock, but for a pause after half of them. */
  timeS(step: number): number {
    return step / 100 + (step > MOTIONS / 2 ? PAUSE_S : 0);
  }
  play(untilS: number, steps: number): void {
    for (let n = 0; n < steps && this.carved < this.motions; n += 1) {
      if (this.timeS(this.carved + 1) > untilS) return;
      this.carve(1);
    }
  }
  /** A hand adds motions to the last one. */
  hand(): void {
    this.isJournal = true;
    this.carved = 0;
  }
  samples(frame: Uint8Array): void {
    if (this.carved !== this.motions) throw new Error('not at the end');
    this.motions += frame.length;
    this.carved = this.motions;
    if (frame.length > 1) throw new Error('the last one is rejected');
  }
  change(): void {
    if (this.fault !== '') throw new Error(this.fault);
    this.samples(new Uint8Array(1));
  }
  parts(): unknown {
    return { record: this.carved, hash: this.hash() };
  }
  changed(): unknown[] {
    this.dirty = 0;
    return [];
  }
  digests(): unknown[] {
    return [{ x: 0, y: 0, digest: `digest ${this.carved}` }];
  }
  mesh(x: number, y: number): unknown {
    const none = { positions: new Float32Array(0), normals: new Float32Array(0) };
    return { x, y, ...none, index: new Uint32Array(0), original: new Uint8Array(0) };
  }
  progress(): Partial<Progress> {
    const next_s = this.carved < this.motions ? this.timeS(this.carved + 1) : null;
    return { carved: this.carved, time_s: this.timeS(this.carved), next_s };
  }
  hash(): string {
    return `state ${this.carved}`;
  }
  model(): Uint8Array {
    return new Uint8Array([this.carved & 0xff]);
  }
}

describe('the worker that carves', () => {
  const clock = { ms: 0 };
  let block: FakeBlock;
  let carver: Carver;
  let posted: FromWorker[];
  let waiting: (() => void)[];

  beforeEach(async () => {
    clock.ms = 0;
    block = new FakeBlock(clock);
    posted = [];
    waiting = [];
    carver = new Carver({
      post: (message) => posted.push(message),
      load: () => Promise.resolve(block as unknown as ProgramBlock),
      later: (act) => waiting.push(act),
      nowMs: () => clock.ms,
    });
    await carver.receive({ type: 'load', module: MODULE });
  });

  const last = (): FromWorker => posted.at(-1)!;
  const run = (slices = Infinity): void => {
    for (let n = 0; n < slices && waiting.length > 0; n += 1) waiting.shift()!();
  };

  it('carves to the end in slices, and shows the state only at rest', async () => {
    await carver.receive({ type: 'open', files: NO_FILES });
    expect(last().type).toBe('opened');
    run(3);
    expect(clock.ms).toBeLessThan(3 * 60);
    run();
    expect(last()).toMatchObject({ hash: 'state 1000', progress: { carved: MOTIONS } });
    const hashes = posted.filter((one) => one.type === 'carved').map(({ hash }) => hash);
    expect(hashes.filter((hash) => hash !== null)).toHaveLength(1);
    expect(hashes.length).toBeGreaterThan(3);
    expect(hashes.length).toBeLessThan((MOTIONS * MOTION_MS) / 150 + 2);
    expect(waiting).toEqual([]);
  });

  it('stops where it is, and goes to where the user wants', async () => {
    await carver.receive({ type: 'open', files: NO_FILES });
    run(5);
    await carver.receive({ type: 'stop' });
    run();
    const { carved } = block;
    expect(carved).toBeGreaterThan(0);
    expect(carved).toBeLessThan(MOTIONS);
    expect(last()).toMatchObject({ hash: `state ${carved}` });
    await carver.receive({ type: 'seek', motion: 250 });
    await carver.receive({ type: 'seek', motion: 20 });
    run();
    expect(last()).toMatchObject({ hash: 'state 20' });
    await carver.receive({ type: 'seek', motion: 5000 });
    run();
    expect(last()).toMatchObject({ hash: 'state 1000' });
  });

  it('carves a journal silently to a record, and on to another one', async () => {
    const journal = { origin: new Uint8Array(), spans: [] };
    await carver.receive({ type: 'journal', journal, to: 100, isSilent: true });
    run();
    expect(last()).toMatchObject({ hash: 'state 100', tiles: [] });
    const seek = vi.spyOn(block, 'seek');
    await carver.receive({ type: 'carve', to: 700 });
    run();
    expect(last()).toMatchObject({ hash: 'state 700' });
    expect(seek).not.toHaveBeenCalled();
    await carver.receive({ type: 'carve', to: 9999 });
    run();
    expect(last()).toMatchObject({ hash: 'state 1000' });
  });

  it('reports why files cannot be read, and reads other ones', async () => {
    [block.fault, block.faultAt] = ['a.ngc:3: no', -1];
    await carver.receive({ type: 'open', files: NO_FILES });
    expect(last()).toEqual({ type: 'rejected', reason: 'a.ngc:3: no' });
    block.faultAt = Infinity;
    await carver.receive({ type: 'open', files: NO_FILES });
    run();
    expect(last()).toMatchObject({ hash: 'state 1000' });
  });

  it('keeps the cuts before a motion that cannot be carved', async () => {
    [block.fault, block.faultAt] = ['a.ngc:9: turns too far', 321];
    await carver.receive({ type: 'open', files: NO_FILES });
    run();
    expect(posted).toContainEqual({ type: 'rejected', reason: 'a.ngc:9: turns too far' });
    expect(last()).toMatchObject({ hash: 'state 321' });
    await carver.receive({ type: 'model', format: 'stl' });
    expect(last()).toMatchObject({ type: 'model', bytes: new Uint8Array([321 & 0xff]) });
  });

  const JOURNAL = { origin: new Uint8Array(), spans: [] };
  const open = async (to: number, isSilent = false): Promise<void> => {
    await carver.receive({ type: 'journal', journal: JOURNAL, to, isSilent });
    run();
  };
  /** Lets time pass in frames until the block rests. */
  const watch = (ms: number): number[] => {
    const seen: number[] = [];
    for (const endMs = clock.ms + ms; clock.ms < endMs && waiting.length > 0; clock.ms += 5) {
      run(1);
      const message = last();
      if (message.type === 'carved') seen.push(message.progress.carved);
    }
    return seen;
  };

  it('replays a journal up to a record, and shows nothing of it if it is to be silent', async () => {
    await open(300);
    expect(last()).toMatchObject({ hash: 'state 300', rate: 0 });
    block.changed = () => {
      throw new Error('meshed');
    };
    await open(400, true);
    expect(last()).toMatchObject({ hash: 'state 400', tiles: [] });
  });

  it('states the digests that the tiles of a journal must have', async () => {
    await carver.receive({ type: 'digests' });
    expect(posted).toEqual([]); // nothing was read
    await open(40, true);
    await carver.receive({ type: 'digests' });
    expect(last()).toEqual({ type: 'digests', tiles: [{ x: 0, y: 0, digest: 'digest 40' }] });
    await carver.receive({ type: 'mesh', x: 2, y: 1 });
    expect(last()).toMatchObject({ type: 'mesh', tile: { x: 2, y: 1 } });
  });

  it('plays with the rate, step by step, and rests where it is stopped', async () => {
    await open(0);
    const beganMs = clock.ms;
    await carver.receive({ type: 'play', rate: 4 });
    const seen = watch(500);
    expect(seen.length).toBeGreaterThan(5);
    const due = (4 * (clock.ms - beganMs)) / 10;
    expect(block.carved).toBeGreaterThan(due - 40);
    expect(block.carved).toBeLessThanOrEqual(due);
    expect(last()).toMatchObject({ rate: 4 });
    await carver.receive({ type: 'stop' });
    run();
    expect(last()).toMatchObject({ hash: `state ${block.carved}`, rate: 0 });
  });

  it('passes over pauses, is late where it cannot keep up, and ends at the end', async () => {
    await open(480);
    await carver.receive({ type: 'play', rate: 1 });
    watch(1000);
    expect(block.carved).toBeGreaterThan(520); // the pause would take an hour
    await carver.receive({ type: 'play', rate: 64 });
    const beganMs = clock.ms;
    const from = block.carved;
    watch(200);
    const possible = (clock.ms - beganMs) / MOTION_MS;
    expect(block.carved - from).toBeLessThanOrEqual(possible);
    watch(5000);
    expect(last()).toMatchObject({ hash: 'state 1000', rate: 0 });
    expect(waiting).toEqual([]);
  });

  it('plays from the place to which it was sent', async () => {
    await open(0);
    await carver.receive({ type: 'seek', motion: 400 });
    await carver.receive({ type: 'play', rate: 1 });
    const seen = watch(1000);
    expect(seen.find((carved) => carved >= 400)).toBe(400);
    expect(block.carved).toBeGreaterThan(400);
    expect(block.carved).toBeLessThan(500);
    expect(last()).toMatchObject({ rate: 1 });
  });

  it('goes to records that have come later', async () => {
    await open(1000);
    await carver.receive({ type: 'records', span: new Uint8Array() });
    await carver.receive({ type: 'seek', motion: 1100 });
    run();
    expect(last()).toMatchObject({ hash: 'state 1100' });
  });

  it('ends where the module ends', async () => {
    await carver.receive({ type: 'open', files: NO_FILES });
    block.carve = () => {
      throw new WebAssembly.RuntimeError('unreachable');
    };
    run();
    expect(last()).toEqual({ type: 'failed', reason: 'unreachable' });
    await carver.receive({ type: 'seek', motion: 1 });
    expect(waiting).toEqual([]);
  });

  const HAND = { type: 'hand', participant: 2, wallMs: 0 } as const;
  const samples = (count: number) =>
    ({
      type: 'samples',
      frame: new Uint8Array(count),
      newest: BigInt(count),
      wallMs: 0,
      spanMs: 0,
    }) as const;

  it('hands a block over at its end, and shows nothing before', async () => {
    await carver.receive({ type: 'open', files: NO_FILES });
    run();
    posted = [];
    await carver.receive(HAND);
    run();
    expect(posted.map(({ type }) => type)).toEqual(['handed', 'carved']);
    expect(block.carved).toBe(MOTIONS);
  });

  it("carves a hand's motions at once, and computes the hash when it rests", async () => {
    await carver.receive({ type: 'open', files: NO_FILES });
    run();
    await carver.receive(HAND);
    run();
    posted = [];
    await carver.receive(samples(1));
    expect(last()).toMatchObject({ type: 'felt', newest: 1n, reason: '' });
    run();
    expect(last()).toMatchObject({
      hash: null,
      progress: { carved: MOTIONS + 1 },
    });
    await carver.receive({ type: 'change', undone: true, wallMs: 0 });
    expect(last()).toMatchObject({ type: 'changed', undone: true, reason: '' });
    run();
    await carver.receive({ type: 'rest' });
    run();
    expect(last()).toMatchObject({ hash: `state ${MOTIONS + 2}` });
    await carver.receive({ type: 'save' });
    expect(last()).toMatchObject({
      type: 'saved',
      parts: { record: MOTIONS + 2 },
    });
  });

  it('says why a sample or an undo is rejected, and goes on', async () => {
    await carver.receive({ type: 'open', files: NO_FILES });
    run();
    await carver.receive(HAND);
    run();
    await carver.receive(samples(2));
    expect(last()).toMatchObject({
      type: 'felt',
      reason: 'the last one is rejected',
    });
    block.fault = 'nothing to undo';
    await carver.receive({ type: 'change', undone: true, wallMs: 0 });
    expect(last()).toMatchObject({
      type: 'changed',
      reason: 'nothing to undo',
    });
    await carver.receive(samples(1));
    expect(last()).toMatchObject({ type: 'felt', reason: '' });
  });
});
