// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, it, vi } from 'vitest';
import { Participants } from '../src/model/participants';
import type { SessionModel } from '../src/model/session';
import { toolName } from '../src/model/tool_profile';
import { People } from '../src/ui/people';
import type { ParticipantInfo, ToolInfo, ToolState } from '../src/wire/types';
import type { FakeElement } from './support/fake_dom';
import { stubPage } from './support/fake_dom';

const ada: ParticipantInfo = {
  participant: 1,
  name: 'Ada',
  color: '#112233',
  tool: 1,
  kind: 'agent',
};

const tool = (id: number, radius_mm: number): ToolInfo =>
  ({
    id,
    shape: 'ball',
    diameter_mm: 2 * radius_mm,
    cutting: [],
    others: [],
  }) as unknown as ToolInfo;

function stateOf(tool_id: number): ToolState {
  return {
    participant: 1,
    tool_id,
    tip_mm: [0, 0, 0],
    axis: [0, 0, 1],
    status: 1,
    force_n: [0, 0, 0],
    torque_nmm: [0, 0, 0],
    removed_rate_mm3_per_s: 0,
    felt_share: 0,
  };
}

afterEach(() => vi.unstubAllGlobals());

it('a row shows the tool that the participant has now, without a new list', () => {
  stubPage();
  const participants = new Participants();
  participants.setList([ada]);
  const tools = [tool(1, 3), tool(2, 5)];
  const model = {
    participants,
    welcome: undefined,
    tool: (id: number) => tools.find((one) => one.id === id),
  } as unknown as SessionModel;
  const people = new People(model, vi.fn(), vi.fn());
  const row = (): string => (people.element as unknown as FakeElement).textContent;
  people.update(null, null, 1000);
  expect(row()).toContain(toolName(tools[0]));
  for (const [n, at] of [1, 0, 1].entries()) {
    participants.applyTools([stateOf(tools[at]!.id)], 2000 + n);
    people.update(null, null, 2000 + n);
    expect(row()).toContain(toolName(tools[at]));
    expect(row()).not.toContain(toolName(tools[1 - at]));
  }
  expect(row()).toContain('Ada');
});
