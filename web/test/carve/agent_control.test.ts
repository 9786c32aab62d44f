// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { parseAgentControl } from '../../src/wire/agent_control';

const WELCOME = {
  type: 'welcome',
  participant: 3,
  epoch: 5,
  color: '#d9541e',
  limits: { samples_per_message: 16, samples_per_s: 1250, speed_mm_per_s: 500, frame_bytes: 4096 },
  resume: { token: 'ab12', resumed: false, agent_sequence: 0 },
};

describe('messages to an agent', () => {
  it('reads the welcome', () => {
    expect(parseAgentControl(JSON.stringify(WELCOME))).toEqual({
      ok: true,
      value: {
        type: 'welcome',
        participant: 3,
        epoch: 5,
        color: '#d9541e',
        speedMmPerS: 500,
        samplesPerMessage: 16,
        samplesPerS: 1250,
        resume: { token: 'ab12', resumed: false, agentSequence: 0n },
        others: [],
      },
    });
  });

  it('reads which other servers there are, and which one has the session', () => {
    const others = ['http://10.0.0.2:8080'];
    const read = (message: object): unknown => parseAgentControl(JSON.stringify(message));
    expect(read({ ...WELCOME, others })).toMatchObject({ value: { others } });
    expect(read({ type: 'servers', others })).toEqual({
      ok: true,
      value: { type: 'servers', others },
    });
    expect(read({ type: 'bye', reason: 'no' })).toMatchObject({ value: { redirect: '' } });
    const bye = { type: 'bye', reason: 'elsewhere', redirect: 'http://10.0.0.2:8080' };
    expect(read(bye)).toEqual({ ok: true, value: bye });
  });

  it('skips unknown messages and rejects invalid ones', () => {
    expect(parseAgentControl('{"type":"participants","participants":[]}')).toEqual({
      ok: true,
      value: null,
    });
    for (const text of ['', '[]', '{"type":"bye"}', JSON.stringify({ ...WELCOME, limits: 1 })])
      expect(parseAgentControl(text).ok).toBe(false);
  });
});
