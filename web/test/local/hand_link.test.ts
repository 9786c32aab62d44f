// SPDX-License-Identifier: Apache-2.0
import { beforeEach, describe, expect, it, vi } from 'vitest';
import type { Draft } from '../../src/carve/sample_log';
import { HandLink } from '../../src/local/hand_link';
import type { FromWorker, ToWorker } from '../../src/local/messages';
import type { About, Progress } from '../../src/local/program_block';
import { decodeFrame } from '../../src/wire/decode';

const OWN = 7;

function draft(ms: number): Draft {
  return {
    time_us: BigInt(1000 * ms),
    tip_mm: [ms, 0, 0],
    axis: [0, 0, 1],
    tool_id: 1,
    buttons: 0,
    felt_share: 0,
  };
}

const drafts = (count: number): Draft[] => Array.from({ length: count }, (_, n) => draft(n));

describe('the link of a hand to the page that has the block', () => {
  const events = {
    status: vi.fn(),
    joined: vi.fn(),
    result: vi.fn(),
    rejected: vi.fn(),
    changed: vi.fn(),
  };
  let posted: ToWorker[];
  let later: () => void;
  let link: HandLink;
  const failed = vi.fn();

  beforeEach(() => {
    vi.clearAllMocks();
    posted = [];
    link = new HandLink(
      {
        post: (message) => posted.push(message),
        participant: () => OWN,
        wallMs: () => 5000,
        later: (act) => (later = act),
      },
      events,
    );
  });

  const felt = (newest: bigint, reason = ''): FromWorker => {
    const tools = [{ participant: OWN, force_n: [1, 2, 2] }];
    const progress = { carved: 9, tools } as unknown as Progress;
    return { type: 'felt', newest, progress, recorded: true, reason };
  };
  const join = (): void => {
    link.join();
    link.heard({ type: 'handed', about: {} as About });
  };

  it('takes samples once the worker has handed the block over', () => {
    link.join();
    expect(posted).toEqual([{ type: 'hand', participant: OWN, wallMs: 5000 }]);
    expect(link.takes).toBe(false);
    link.heard({ type: 'handed', about: {} as About });
    expect(link.takes).toBe(true);
    expect(events.joined).toHaveBeenCalledWith(expect.objectContaining({ participant: OWN }));
  });

  it('waits for an answer to each sample and to each undo', () => {
    join();
    expect(link.isAsking).toBe(false);
    link.send(drafts(20));
    link.heard(felt(16n));
    expect(link.isAsking).toBe(true);
    link.heard(felt(20n));
    expect(link.isAsking).toBe(false);
    link.change(true, 1, failed);
    expect(link.isAsking).toBe(true);
    link.heard({ type: 'changed', undone: true, reason: '' });
    expect(link.isAsking).toBe(false);
    link.send(drafts(1));
    link.drop();
    expect(link.isAsking).toBe(false);
  });

  it('numbers samples, and divides long paths into frames', () => {
    join();
    link.send(drafts(20));
    link.send(drafts(1));
    const frames = posted.flatMap((one) => (one.type === 'samples' ? [one] : []));
    expect(frames.map(({ newest, spanMs }) => [newest, spanMs])).toEqual([
      [16n, 15],
      [20n, 3],
      [21n, 0],
    ]);
    const numbers = frames.flatMap(({ frame }) => {
      const decoded = decodeFrame(frame.slice().buffer);
      if (!decoded.ok || decoded.value.kind !== 'motion') throw new Error('no motions');
      return decoded.value.samples.map(({ agent_sequence: number }) => Number(number));
    });
    expect(numbers).toEqual(Array.from({ length: 21 }, (_, n) => n + 1));
  });

  it('waits for a worker that is behind, and feels its answers', () => {
    join();
    link.send(drafts(300));
    expect(link.takes).toBe(false);
    link.heard(felt(299n));
    expect(link.takes).toBe(true);
    expect(events.result).toHaveBeenCalledWith({
      agent_sequence: 299n,
      motions_applied: 9n,
      force_n: [1, 2, 2],
    });
    link.heard(felt(300n, 'the axis is not of unit length'));
    expect(events.rejected).toHaveBeenCalledWith('rejected', 'the axis is not of unit length');
  });

  it('asks to undo and redo, and says when the hand rests', () => {
    join();
    link.ask();
    expect(link.isAsking).toBe(false);
    link.change(true, 1, failed);
    expect(link.isAsking).toBe(true);
    expect(posted.at(-1)).toEqual({ type: 'change', undone: true, wallMs: 5000 });
    link.heard({ type: 'changed', undone: true, reason: '' });
    expect(link.isAsking).toBe(false);
    expect(events.changed).toHaveBeenCalledWith(true);
    link.change(false, 1, failed);
    link.heard({ type: 'changed', undone: false, reason: 'there is no stroke to redo' });
    expect(events.rejected).toHaveBeenCalledWith('bad_message', 'There is no stroke to redo.');
    expect(failed).toHaveBeenCalledOnce();
    later();
    expect(posted.at(-1)).toEqual({ type: 'rest' });
  });

  it('numbers samples from 1 again for another block', () => {
    join();
    link.send(drafts(300));
    link.drop();
    expect(link.status).toBe('off');
    join();
    expect(link.takes).toBe(true);
  });
});
