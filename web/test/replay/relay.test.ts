// SPDX-License-Identifier: Apache-2.0
// A relay between a server and a page that does not pass mesh frames on as they are: the page loses
// "Live" within five seconds, whichever frame it is, and never without such a fault.

import { MeshoptDecoder } from 'three/examples/jsm/libs/meshopt_decoder.module.js';
import { afterEach, beforeAll, beforeEach, describe, expect, it, vi } from 'vitest';
import { readMeshGlb } from '../../src/decode/mesh_glb';
import { ViewLink } from '../../src/link/view_link';
import { SessionModel } from '../../src/model/session';
import { badgeOf } from '../../src/ui/badge';
import { MESH_SNAPSHOT_LAST } from '../../src/wire/types';
import { digestsIn, readMeshStream, StreamServer } from '../support/mesh_stream';
import type { Deliver, StreamPart } from '../support/mesh_stream';

const FAULTS = 300;
const NOTICED_MS = 5000;
const STEP_MS = 200;
const NOT_PASSED_ON = null;

/** The relay's action on the mesh frame of a number; all other frames pass. */
type Fault = (frame: ArrayBuffer, n: number, pass: (frame: ArrayBuffer) => void) => void;

/** Numbers from 0 to 1, equal for equal seeds (mulberry32). */
function randomOf(seed: number): () => number {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let mixed = Math.imul(state ^ (state >>> 15), 1 | state);
    mixed = (mixed + Math.imul(mixed ^ (mixed >>> 7), 61 | mixed)) ^ mixed;
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 2 ** 32;
  };
}

class Page {
  readonly model = new SessionModel();
  readonly link: ViewLink;
  meshes = 0; // that the server has sent
  losses = 0;
  private readonly beganMs_ = performance.now();
  private readonly server_: StreamServer;

  constructor(parts: readonly StreamPart[], fault: Fault | typeof NOT_PASSED_ON) {
    const pass = (frame: ArrayBuffer): void => this.server_.arrive(frame);
    const relay: Deliver = (data, kind) => {
      if (kind !== 'mesh') this.server_.arrive(data);
      else if (fault) fault(data as ArrayBuffer, this.meshes++, pass);
      else pass(data as ArrayBuffer);
    };
    this.server_ = new StreamServer(parts, () => this.nowMs, relay);
    const { model } = this;
    const nothing = (): undefined => undefined;
    this.link = new ViewLink(
      {
        url: 'ws://host/v1/sessions/demo/view',
        name: 'Tester',
        open: () => this.server_,
        probe: () => new Promise(nothing), // it does not come back: the fault was noticed
        look: () => null,
        reloadAt: () => false,
        budget: 0,
        nowMs: () => performance.now(),
      },
      {
        greeted: nothing,
        served: nothing,
        renamed: nothing,
        tools: nothing,
        status: (status, reason) => {
          model.setStatus(status, reason);
          if (status === 'reconnecting') this.losses += 1;
        },
        message: (message) => model.apply(message, performance.now()),
        mesh: async (header, glb) => {
          model.meshArrived(header, glb.byteLength, performance.now());
          await Promise.resolve();
          const frame = readMeshGlb(glb, MeshoptDecoder);
          for (const { x, y, version, level, digest } of frame.nodes)
            model.tiles.offer(x, y, version, 0, level, digest);
          model.lag.pictured(frame.motions);
          if (header.flags & MESH_SNAPSHOT_LAST) model.tiles.finishSnapshot();
        },
        pinged: () => model.liveness.pinged(),
        pong: (sent, received, serverUs) => model.pong(sent, received, serverUs),
        late: (isLate) => (model.lag.isMissing = isLate),
        problem: (reason) => model.addProblem(reason),
      },
    );
    this.link.start();
    this.server_.open();
  }

  /** Since the beginning of the stream. */
  get nowMs(): number {
    return performance.now() - this.beganMs_;
  }

  get isLive(): boolean {
    return badgeOf(this.model, performance.now()).state === 'connected';
  }

  /** Goes on by the simulated clock; returns whether the badge said "Live" all the time. */
  async run(ms: number, look: () => void = () => undefined): Promise<boolean> {
    let isLive = true;
    for (const endMs = performance.now() + ms; performance.now() < endMs;) {
      await vi.advanceTimersByTimeAsync(STEP_MS);
      this.model.liveness.beat(performance.now());
      this.server_.serve();
      await vi.advanceTimersByTimeAsync(0);
      isLive &&= this.isLive;
      look();
    }
    return isLive;
  }

  /** Digests of the tiles that are displayed. */
  digests(): Map<string, string | undefined> {
    return new Map(this.model.tiles.list().map(({ x, y, digest }) => [`${x} ${y}`, digest]));
  }
}

describe('a page behind a relay', () => {
  let parts: StreamPart[];
  let frames: StreamPart[];
  beforeAll(async () => {
    await MeshoptDecoder.ready;
    parts = readMeshStream();
    frames = parts.filter(({ kind }) => kind === 'mesh');
  });
  beforeEach(() => {
    vi.useFakeTimers({ now: 0 });
  });
  afterEach(() => {
    vi.useRealTimers();
  });

  /** The fault of a seed: its kind, and the frame that it concerns. */
  function faultOf(seed: number): { name: string; at: number; fault: Fault } {
    const random = randomOf(seed);
    const snapshot = frames.filter(({ ms }) => ms === 0).length;
    // Of the first minutes, so that a trial is short; the last frame of the snapshot is one too.
    const at = Math.max(1, snapshot - 1) + Math.floor(random() * 6);
    const laterMs = 2100 + random() * 20_000;
    const [place, bit] = [random(), Math.floor(random() * 8)];
    const older = Math.floor(random() * at);
    let before: ArrayBuffer[] = [];
    let held: ArrayBuffer | null = null;
    const faults: Record<string, Fault> = {
      drop: (frame, n, pass) => {
        if (n !== at) pass(frame);
      },
      withhold: (frame, n, pass) => {
        if (n < at) pass(frame);
      },
      'delay one': (frame, n, pass) => {
        if (n === at) setTimeout(() => pass(frame), laterMs);
        else pass(frame);
      },
      'delay all': (frame, n, pass) => {
        if (n >= at) setTimeout(() => pass(frame), laterMs);
        else pass(frame);
      },
      swap: (frame, n, pass) => {
        if (n === at) held = frame;
        else pass(frame);
        if (n === at + 1) pass(held!);
      },
      'replay an old one': (frame, n, pass) => {
        before = [...before, frame];
        pass(n === at ? before[older]! : frame);
      },
      repeat: (frame, n, pass) => {
        pass(frame);
        if (n === at) pass(frame.slice(0));
      },
      corrupt: (frame, n, pass) => {
        const bytes = new Uint8Array(frame);
        if (n === at) bytes[Math.floor(place * bytes.length)]! ^= 1 << bit;
        pass(frame);
      },
    };
    const names = Object.keys(faults);
    const name = names[seed % names.length]!;
    return { name, at, fault: faults[name]! };
  }

  it('has recorded frames with a checksum, of tiles with digests', () => {
    expect(frames.length).toBeGreaterThan(25);
    expect(parts.at(-1)!.ms).toBeGreaterThan(27 * 60_000);
  });

  it(`notices each of ${FAULTS} random faults within five seconds`, async () => {
    const missed: string[] = [];
    for (let seed = 0; seed < FAULTS; ++seed) {
      const { name, at, fault } = faultOf(seed);
      const page = new Page(parts, fault);
      let faultMs = Infinity;
      let noticedMs = Infinity;
      const untilMs = frames[at]!.ms + NOTICED_MS + 1000;
      await page.run(untilMs, () => {
        if (page.meshes > at) faultMs = Math.min(faultMs, page.nowMs);
        if (!page.isLive) noticedMs = Math.min(noticedMs, page.nowMs);
      });
      if (!(noticedMs >= faultMs && noticedMs - faultMs <= NOTICED_MS))
        missed.push(`${name} of frame ${at} (seed ${seed}): ${noticedMs - faultMs} ms`);
      page.link.stop();
      vi.clearAllTimers();
    }
    expect(missed).toEqual([]);
  }, 300_000);

  it('notices nothing in half an hour without a fault, and shows the block', async () => {
    const page = new Page(parts, NOT_PASSED_ON);
    const expected = parts.filter(({ kind }) => kind === 'digests');
    let compared = 0;
    const isLive = await page.run(30 * 60_000, () => {
      const now = page.nowMs;
      const at = expected.filter(({ ms }) => ms <= now).at(-1)!;
      if (expected.some(({ ms }) => Math.abs(ms - now) <= STEP_MS)) return; // just sent
      expect(page.digests()).toEqual(digestsIn(at));
      compared += 1;
    });
    expect(isLive).toBe(true);
    expect(page.losses).toBe(0);
    expect(page.model.problems).toBe(0);
    expect(compared).toBeGreaterThan(5000);
    page.link.stop();
  }, 300_000);
});
