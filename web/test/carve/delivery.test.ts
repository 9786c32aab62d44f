// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { CarveStatus } from '../../src/carve/carve_link';
import { Delivery } from '../../src/carve/delivery';
import type { ToolRequest } from '../../src/carve/tool/path_queue';
import type { Draft } from '../../src/carve/sample_log';
import { Sampler } from '../../src/carve/sampler';
import type { Vec3 } from '../../src/wire/types';

class FakeLink {
  takes = true;
  waiting = 0;
  status: CarveStatus = 'off';
  /** Samples as `x,y` where they cut, else `up`; requests by their type. */
  readonly log: string[] = [];
  join(): void {
    if (this.status === 'off') this.log.push('join');
    this.status = 'ready';
  }
  leave(): void {
    this.log.push('leave');
    this.status = 'off';
  }
  send(drafts: readonly Draft[]): void {
    for (const { tip_mm: tip, buttons } of drafts)
      this.log.push(buttons ? `${tip[0]},${tip[1]}` : 'up');
  }
  ask({ type }: ToolRequest): void {
    this.log.push(type);
  }
  change(undone: boolean, strokes: number): void {
    for (let n = 0; n < strokes; n += 1) this.log.push(undone ? 'undo' : 'redo');
  }
  accepted(from: number, to: number): number | null {
    return to - from;
  }
}

describe('delivery', () => {
  let link: FakeLink;
  let path: Sampler;
  let delivery: Delivery;
  let ended: boolean;

  beforeEach(() => {
    vi.useFakeTimers();
    vi.advanceTimersByTime(1000);
    link = new FakeLink();
    path = new Sampler(1);
    path.limits = { speedMmPerS: 500, samplesPerS: 1250 };
    ended = false;
    delivery = new Delivery(link, path, () => ended);
    delivery.join();
  });
  afterEach(() => vi.useRealTimers());

  /** A stroke of 100 mm, a quarter of a second for a guest. */
  function stroke(y: number): void {
    const pose = (x: number, z: number): { tip: Vec3; axis: Vec3 } => ({
      tip: [x, y, z],
      axis: [0, 0, 1],
    });
    path.push(pose(0, 5), false);
    path.push(pose(0, 0), true);
    path.push(pose(100, 0), true);
    path.push(pose(100, 5), false);
    path.endGesture();
  }

  function ends(): string[] {
    return link.log.filter((one) => /^100,|undo|redo|tool|join|leave/.test(one));
  }

  it('drops a stroke of which nothing is sent, and no other, when it is undone', () => {
    for (const y of [1, 2, 3]) stroke(y);
    vi.advanceTimersByTime(50);
    expect(path.undo()).toBe(true);
    vi.advanceTimersByTime(3000);
    expect(ends()).toEqual(['join', '100,1', '100,2']);
    expect(link.log).not.toContain('0,3');
    expect(link.log.at(-1)).toBe('up');
  });

  it('asks the server after the whole stroke, and before the next, when a part is sent', () => {
    stroke(1);
    vi.advanceTimersByTime(50);
    expect(link.log.some((one) => one.endsWith(',1'))).toBe(true);
    expect(path.undo()).toBe(false);
    stroke(2);
    vi.advanceTimersByTime(3000);
    expect(ends()).toEqual(['join', '100,1', 'undo', '100,2']);
    expect(link.log.slice(link.log.indexOf('undo') - 1)[0]).toBe('up');
  });

  it('redoes in reverse order the strokes that waited and those that the server undid', () => {
    stroke(1);
    vi.advanceTimersByTime(1000);
    stroke(2);
    expect([path.undo(), path.undo()]).toEqual([true, false]);
    expect([path.redo(), path.redo(), path.redo()]).toEqual([false, true, false]);
    vi.advanceTimersByTime(1000);
    expect(ends()).toEqual(['join', '100,1', 'undo', 'redo', '100,2', 'redo']);
    expect(link.log.slice(link.log.indexOf('redo') + 1)[0]).toBe('up');
  });

  it('forgets undone strokes when another stroke is drawn', () => {
    stroke(1);
    stroke(2);
    expect(path.undo()).toBe(true);
    stroke(3);
    expect(path.redo()).toBe(false);
    vi.advanceTimersByTime(2000);
    expect(ends()).toEqual(['join', '100,1', '100,3', 'redo']);
  });

  it('changes the tool after the motions of the earlier one', () => {
    stroke(1);
    path.ask({ type: 'tool', tool: 2 });
    path.ask({ type: 'tool', tool: 3 });
    stroke(2);
    vi.advanceTimersByTime(2000);
    expect(ends()).toEqual(['join', '100,1', 'tool', '100,2']);
  });

  it('leaves when all that was drawn is sent, also after a stall', () => {
    stroke(1);
    link.takes = false;
    vi.advanceTimersByTime(800);
    stroke(2);
    delivery.leave();
    vi.advanceTimersByTime(800);
    expect(ends()).toEqual(['join']);
    link.takes = true;
    vi.advanceTimersByTime(2000);
    expect(ends()).toEqual(['join', '100,1', '100,2', 'leave']);
    expect(link.log.slice(-2)).toEqual(['up', 'leave']);
  });

  it('leaves only when the link has resent the samples that the server may lack', () => {
    link.waiting = 40;
    delivery.leave();
    vi.advanceTimersByTime(800);
    expect(link.log).toEqual(['join']);
    link.waiting = 0;
    vi.advanceTimersByTime(20);
    expect(link.log.at(-1)).toBe('leave');
  });

  it('stays when it is joined again before that', () => {
    stroke(1);
    vi.advanceTimersByTime(20);
    delivery.leave();
    delivery.join();
    vi.advanceTimersByTime(2000);
    expect(ends()).toEqual(['join', '100,1']);
  });

  it('does not wait for a session that has ended', () => {
    stroke(1);
    link.takes = false;
    delivery.leave();
    ended = true;
    vi.advanceTimersByTime(20);
    expect(link.log.at(-1)).toBe('leave');
    expect(path.waiting).toBe(0);
  });
});
