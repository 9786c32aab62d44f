// SPDX-License-Identifier: Apache-2.0
// Undo and redo take gestures whole, whichever of their strokes the block has rejected: random
// gestures, undos and redos against a plain model. The block is the kernel of kerf.html, which has
// one state for one set of strokes; or a server that loses results, and answers late.

import { existsSync, readFileSync } from 'node:fs';
import { describe, expect, it, vi } from 'vitest';
import { CarveLink } from '../../src/carve/carve_link';
import type { AgentLink } from '../../src/carve/carve_link';
import { Sampler } from '../../src/carve/sampler';
import type { Image } from '../../src/carve/tool/path_queue';
import { Carver } from '../../src/local/carver';
import { exampleBlock } from '../../src/local/example';
import { NO_FILES } from '../../src/local/given_files';
import { HandLink } from '../../src/local/hand_link';
import type { FromWorker } from '../../src/local/messages';
import { ProgramBlock } from '../../src/local/program_block';
import type { Stroke } from '../../src/model/stroke';
import { decodeFrame } from '../../src/wire/decode';
import { encodeFrame } from '../../src/wire/encode';
import { BUTTON_CUTTING, FrameType, STATUS_REJECTED } from '../../src/wire/types';
import type { Vec3 } from '../../src/wire/types';
import { FakeCopy, FakeSocket, WELCOME } from './fake_link';

const FILES = new URL('../../public/kerf_files.wasm', import.meta.url);
const UP: Vec3 = [0, 0, 1];
const SIDE_MM = 20; // images are so far from their strokes
const EVENTS = Number(process.env['KERF_EVENTS'] ?? 24);
/** A block takes no motion so far away. */
const FAR_MM = 1e8;

function randomOf(seed: number): () => number {
  let state = seed;
  return () => (state = (state * 48271) % 2147483647) / 2147483647;
}

function pick(random: () => number, count: number): number {
  return Math.floor(count * random());
}

/** An image that the block takes, or one that it does not. */
function imageTo(isTaken: boolean, n: number): Image {
  return ({ tip: [x, y, z], axis }) => ({
    tip: [x + (n + 1) * SIDE_MM, isTaken ? y : FAR_MM, z],
    axis,
  });
}

interface Bench {
  link: AgentLink;
  /** Carves everything that the block was sent. Returns its state, or null if more is to come. */
  settle(): Promise<string | null>;
}

class Player {
  readonly sampler = new Sampler(1);
  private atMs_ = 1000;

  constructor(readonly bench: Bench) {
    this.sampler.limits = { speedMmPerS: 5000, samplesPerS: 1250 };
    bench.link.join();
  }

  draw(at: number, strokes: number, isTaken: boolean, images: readonly Image[]): void {
    const { sampler } = this;
    sampler.images = images;
    // Apart, so that none is inside another.
    const band = Math.round(10 * (at % 1));
    const y = isTaken ? -54 + 20 * band + 0.8 * Math.floor(at) : FAR_MM;
    for (let n = 0; n < strokes; n += 1) {
      const x = -30 + 4 * n;
      sampler.push({ tip: [x, y, 5], axis: UP }, false);
      for (const z of [-1, -1.5])
        sampler.push({ tip: [x, y + z / 4, z - at / 20], axis: UP }, true);
      sampler.push({ tip: [x, y, 5], axis: UP }, false);
    }
    sampler.endGesture();
  }

  async step(): Promise<void> {
    const { link } = this.bench;
    this.atMs_ += 8;
    if (!link.takes) return;
    link.send(this.sampler.take(1000 * this.atMs_));
    const count = (from: number, to: number): number | null => link.accepted(from, to);
    for (const request of this.sampler.takeRequests(count))
      if (request.type === 'change') link.change(request.undone, request.strokes, request.failed);
    await Promise.resolve();
  }

  async settle(): Promise<string> {
    for (let n = 0; n < 400; n += 1) {
      await this.step();
      const state = await this.bench.settle();
      const isDone = this.sampler.waiting === 0 && !this.bench.link.isAsking;
      if (isDone && state !== null) return state;
    }
    throw new Error('the path does not come to its end');
  }
}

/** Plays random events; the model: a gesture counts if the block takes at least one stroke of it. */
async function play(player: Player, seed: number): Promise<void> {
  const random = randomOf(seed);
  let done: { number: number; isTaken: boolean }[] = [];
  let undone: typeof done = [];
  const states = new Map<string, string>([['', await player.settle()]]);
  for (let event = 1; event <= EVENTS; event += 1) {
    for (let together = 1 + pick(random, 3); together > 0; together -= 1) {
      const what = random();
      if (what < 0.45) {
        const number = event + together / 10;
        const strokes = 1 + pick(random, 2);
        const taken = Array.from({ length: pick(random, 3) }, () => random() < 0.5);
        const isTaken = random() < 0.8;
        // All of it may be rejected.
        player.draw(number, strokes, isTaken, taken.map(imageTo));
        undone = [];
        done.push({ number, isTaken });
        // Else a server's list does not tell which of two gestures on the way was rejected.
        if (!(isTaken && taken.every(Boolean))) await player.settle();
      } else if (what < 0.8 && done.some(({ isTaken }) => isTaken)) {
        // One that the block has rejected is passed over, unless it only waited.
        const at = player.sampler.undo()
          ? done.length - 1
          : done.map(({ isTaken }) => isTaken).lastIndexOf(true);
        undone.push(done[at]!);
        done = done.slice(0, at);
      } else if (what >= 0.8 && undone.length > 0) {
        player.sampler.redo();
        done.push(undone.pop()!);
      }
      for (let n = pick(random, 3); n > 0; n -= 1) await player.step();
    }
    const state = await player.settle();
    const key = done
      .filter(({ isTaken }) => isTaken)
      .map(({ number }) => number)
      .join();
    expect(state, `after event ${event}`).toBe(states.get(key) ?? state);
    const [same] = [...states].find(([one, other]) => one !== key && other === state) ?? [key];
    expect(same, 'one state of two sets').toBe(key);
    states.set(key, state);
  }
}

async function kernelBench(): Promise<Bench> {
  const block = await ProgramBlock.of(await WebAssembly.compile(readFileSync(FILES)));
  let link: HandLink | null = null;
  let wall = 1_000_000;
  const later: (() => void)[] = [];
  const answers: FromWorker[] = [];
  const carver = new Carver({
    post: (message) => answers.push(message),
    load: () => Promise.resolve(block),
    later: (act) => later.push(act),
    nowMs: () => performance.now(),
  });
  const queue: Parameters<Carver['receive']>[0][] = [];
  const settle = async (): Promise<string | null> => {
    for (const message of queue.splice(0)) {
      await carver.receive(message);
    }
    for (let n = 0; n < 50 && later.length > 0; n += 1) later.shift()!();
    for (const answer of answers.splice(0)) link!.heard(answer);
    return queue.length === 0 && link!.status === 'ready' ? block.hash() : null;
  };
  link = new HandLink(
    {
      ...{ post: (message) => queue.push(message), participant: () => 2 },
      ...{ wallMs: () => ++wall, later: () => undefined },
    },
    { status: vi.fn(), joined: vi.fn(), result: vi.fn(), rejected: vi.fn(), changed: vi.fn() },
  );
  queue.push(
    { type: 'load', module: {} },
    {
      type: 'open',
      files: {
        ...NO_FILES,
        scene: exampleBlock([{ id: 1, shape: 'ball', diameter_mm: 3, length_mm: 25 }]),
      },
    },
  );
  return { link, settle };
}

/** A server that orders strokes as Kerf's does, and loses results. */
class FakeServer {
  readonly strokes: Stroke[] = [];
  private readonly undone_: Stroke[] = [];
  private record_ = 0;
  private stroke_: Stroke | null = null;
  private read_ = 0;
  private texts_ = 1;

  constructor(
    private readonly socket: FakeSocket,
    private readonly random: () => number,
  ) {}

  /** The strokes that begin at a record or later. */
  list(since: number): Promise<Stroke[]> {
    return Promise.resolve(this.strokes.filter(({ id }) => id >= since));
  }

  work(): void {
    const { socket } = this;
    let newest = 0n;
    let status = 0;
    for (; this.read_ < socket.frames.length; this.read_ += 1) {
      const frame = decodeFrame(socket.frames[this.read_]!.slice().buffer);
      if (!frame.ok || frame.value.kind !== 'motion') continue;
      status = 0;
      for (const { agent_sequence, buttons, tip_mm } of frame.value.samples) {
        newest = agent_sequence;
        const cuts = (buttons & BUTTON_CUTTING) !== 0;
        if (!cuts) this.stroke_ = null;
        if (tip_mm[1] > FAR_MM / 2) {
          status = STATUS_REJECTED;
          socket.say({ type: 'error', code: 'bad_pose', reason: 'too far', fatal: false });
        } else if (cuts) {
          this.cut_();
        }
      }
    }
    if (newest > 0n) this.answer_(newest, status); // of the last frame only
    for (; this.texts_ < socket.texts.length; this.texts_ += 1) {
      const { type } = socket.texts[this.texts_]!;
      if (type === 'undo' || type === 'redo') this.change_(type === 'undo');
    }
  }

  get state(): string {
    return this.strokes
      .filter(({ undone }) => !undone)
      .map(({ id }) => id)
      .join();
  }

  private cut_(): void {
    this.record_ += 1;
    if (!this.stroke_) {
      const numbers = { id: this.record_, last: this.record_, participant: 3, tool: 1 };
      this.stroke_ = { ...numbers, motions: 0, begin_ms: 0, end_ms: 0, undone: false };
      this.strokes.push(this.stroke_);
    }
  }

  private change_(undo: boolean): void {
    const stroke = undo ? this.strokes.filter(({ undone }) => !undone).at(-1) : this.undone_.pop();
    this.record_ += 1;
    this.stroke_ = null;
    if (stroke) stroke.undone = undo;
    if (stroke && undo) this.undone_.push(stroke);
    const failure = stroke ? {} : { code: 'bad_message', reason: 'no stroke' };
    this.socket.say({ type: 'stroke', undone: undo, ...failure });
  }

  private answer_(newest: bigint, status: number): void {
    const none: Vec3 = [0, 0, 0];
    const header = { type: FrameType.Result, flags: 0, epoch: 5, sequence: 1n, time_us: 1n };
    const bytes = encodeFrame({
      header,
      kind: 'result',
      result: {
        ...{ agent_sequence: newest, agent_time_us: 0n, motions_applied: 0n, force_n: none },
        ...{ torque_nmm: none, engaged_area_mm2: 0, direction: none, cut_centre_mm: none },
        ...{ specific_force_n_per_mm2: 0, removed_mm3: 0, status, collision_force_n: none },
        ...{ turnaround_us: 0, planes: [] },
      },
    });
    this.socket.onmessage?.({ data: bytes.slice().buffer });
  }

  get isIdle(): boolean {
    const { frames, texts } = this.socket;
    return this.read_ === frames.length && this.texts_ === texts.length;
  }

  get isLate(): boolean {
    return this.random() < 0.4;
  }
}

function serverBench(random: () => number): Bench {
  const socket = new FakeSocket('', '');
  const server = new FakeServer(socket, random);
  const link = new CarveLink(
    {
      ...{ url: 'ws://host/v1/sessions/s/agent', open: () => socket, copy: new FakeCopy() },
      who: () => ({ name: 'Grace', color: '#d9541e', tool: 1 }),
      nowMs: () => 0,
      list: (since) => server.list(since),
    },
    { status: vi.fn(), joined: vi.fn(), result: vi.fn(), rejected: vi.fn(), changed: vi.fn() },
  );
  link.join();
  socket.onopen?.();
  socket.say(WELCOME);
  const settle = async (): Promise<string | null> => {
    if (!server.isLate) server.work();
    for (let n = 0; n < 5; n += 1) await Promise.resolve();
    return server.isIdle ? server.state : null;
  };
  return { link, settle };
}

describe('undo and redo of gestures', () => {
  it.skipIf(!existsSync(FILES))(
    'are whole in kerf.html, to the hash of the block',
    async () => {
      await play(new Player(await kernelBench()), 48);
    },
    120_000,
  );

  it.each([1, 2, 3, 4, 5])('are whole at a server that rejects strokes (%i)', async (seed) => {
    vi.useFakeTimers({ toFake: ['setInterval', 'setTimeout'] });
    const bench = serverBench(randomOf(1000 * seed));
    await play(new Player(bench), seed);
    bench.link.leave();
    vi.useRealTimers();
  });

  it.skipIf(!existsSync(FILES))(
    'of a mirrored stroke gives the hash of the block before',
    async () => {
      const bench = await kernelBench();
      const player = new Player(bench);
      const before = await player.settle();
      player.draw(1.1, 1, true, [imageTo(true, 0)]);
      const cut = await player.settle();
      expect(cut).not.toBe(before);
      player.sampler.undo();
      expect(await player.settle()).toBe(before);
      player.sampler.redo();
      expect(await player.settle()).toBe(cut);
    },
  );
});
