// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { Liveness } from '../src/model/liveness';
import { SessionModel } from '../src/model/session';
import { badgeOf, connectionText } from '../src/ui/badge';

/** Lets the page run from one time to another. */
function run(liveness: Liveness, fromMs: number, toMs: number): void {
  for (let now = fromMs; now <= toMs; now += 100) liveness.beat(now);
}

describe('liveness', () => {
  it('reports a ping that has no answer for more than 2.5 s', () => {
    const line = new Liveness();
    run(line, 0, 1000);
    line.pinged();
    run(line, 1100, 3400);
    expect(line.overdueMs).toBe(0);
    line.pinged(); // the next one does not hide the first
    run(line, 3500, 6000);
    expect(line.overdueMs).toBeGreaterThan(4900);
    expect(line.overdueMs).toBeLessThan(5100);
    expect(line.answered(3400, 6000)).toBe(true);
    run(line, 6100, 9000);
    expect(line.overdueMs).toBe(0);
  });

  it('does not blame the line while the page stands still', () => {
    const line = new Liveness();
    run(line, 0, 1000);
    line.pinged();
    line.beat(9000); // the page did nothing for 8 s
    expect(line.overdueMs).toBe(0);
  });

  it('takes no round trip during which the page stood still', () => {
    const line = new Liveness();
    run(line, 0, 1000);
    line.pinged();
    expect(line.answered(1000, 1040)).toBe(true);
    line.pinged();
    expect(line.answered(1050, 3000)).toBe(false); // read late: no beat since 1000
    line.pinged();
    line.beat(3010);
    expect(line.answered(2000, 3020)).toBe(false); // sent before the page came back
    run(line, 3100, 4000);
    line.pinged();
    expect(line.answered(3900, 4010)).toBe(true);
  });
});

describe('badge', () => {
  it('names the state of the line: live, silent, reconnecting', () => {
    const model = new SessionModel();
    model.setStatus('connected', '');
    run(model.liveness, 0, 1000);
    model.liveness.pinged();
    model.pong(1000, 1012, 5_000_000n);
    expect(badgeOf(model, 1020)).toEqual({ state: 'connected', label: 'Live', brief: '' });
    expect(connectionText(model, 1020)).toBe('Round trip 12 ms · 0 frames/s · up to date');
    model.liveness.pinged();
    run(model.liveness, 1100, 8000);
    expect(badgeOf(model, 8000)).toEqual({
      state: 'silent',
      label: 'No answer',
      brief: 'for 7 s',
    });
    model.setStatus('reconnecting', 'The server stopped answering.');
    expect(badgeOf(model, 8000)).toMatchObject({ label: 'Reconnecting', brief: '' });
    expect(connectionText(model, 8000)).toBe('–');
  });

  it('keeps the round trip of the line when the page was busy', () => {
    const model = new SessionModel();
    model.setStatus('connected', '');
    run(model.liveness, 0, 1000);
    model.pong(1000, 1012, 5_000_000n);
    model.pong(1020, 2050, 5_000_000n); // nothing ran between
    expect(model.clock.rttMs).toBe(12);
  });
});
