// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { signal } from '@preact/signals';
import { h } from 'preact';
import { beforeEach, describe, expect, it, vi } from 'vitest';
import { SessionModel } from '../src/model/session';
import { toolName } from '../src/model/tool_profile';
import { People } from '../src/ui/people';
import { PersonChoice } from '../src/ui/person_choice';
import type { ParticipantInfo, ToolInfo, ToolState, Welcome } from '../src/wire/types';
import { show } from './support/shown';
import { turn } from './support/turn';

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

const grace: ParticipantInfo = { participant: 2, name: 'Grace', color: '#445566', kind: 'viewer' };
const bo: ParticipantInfo = { ...ada, participant: 3, name: 'Bo' };
const tools = [tool(1, 3), tool(2, 5)];

let model: SessionModel;
let picture: { followed: number | null; follow: (id: number | null) => void };
let choice: PersonChoice;

function join(...participants: ParticipantInfo[]): void {
  const plain = { type: 'welcome', participant: 2, tools, participants };
  model.apply(plain as unknown as Welcome);
}

beforeEach(() => {
  model = new SessionModel();
  const followed = signal<number | null>(null);
  picture = {
    get followed() {
      return followed.value;
    },
    follow: (id) => (followed.value = id),
  };
  choice = new PersonChoice(model.participants, picture);
});

describe('the list of participants', () => {
  const nowMs = signal(0);
  const renamed = vi.fn();
  let lists: HTMLElement;

  beforeEach(() => {
    vi.clearAllMocks();
    nowMs.value = 1000;
    lists = show(h(People, { model, choice, nowMs, renamed }));
  });

  const people = (): string[] => [...lists.querySelectorAll('.people li')].map(textOf);
  const watchers = (): string[] => [...lists.querySelectorAll('.watchers li')].map(textOf);
  function textOf({ textContent }: Element): string {
    return textContent;
  }
  const row = (): HTMLElement => lists.querySelector('.person')!;

  it('shows the tool that a participant has now, without a new list', async () => {
    join(ada);
    await turn();
    expect(row().textContent).toContain(toolName(tools[0]));
    for (const [n, at] of [1, 0, 1].entries()) {
      model.participants.applyTools([stateOf(tools[at]!.id)], 2000 + n);
      nowMs.value = 2000 + n;
      await turn();
      expect(row().textContent).toContain(toolName(tools[at]));
      expect(row().textContent).not.toContain(toolName(tools[1 - at]));
    }
    expect(row().textContent).toContain('Ada');
  });

  it('follows the list of the session', async () => {
    expect(people()).toEqual(['Nobody is carving.']);
    join(ada, grace);
    await turn();
    expect(people()).toHaveLength(1);
    expect(watchers()).toEqual(['Grace (you)']);
    model.participants.change({
      type: 'participants_changed',
      changed: [bo, { ...grace, participant: 4, name: 'Lin' }],
      left: [1],
      viewers: 12,
    });
    await turn();
    expect(people().map((text) => text.slice(0, 2))).toEqual(['Bo']);
    expect(watchers()).toEqual(['Grace (you)', 'Lin', '10 watching']);
  });

  it('says whether a tool cuts, and is idle without news of it', async () => {
    join(ada);
    model.participants.applyTools([stateOf(1)], 1000);
    nowMs.value = 1100;
    await turn();
    const state = lists.querySelector('.person-state')!;
    expect([state.textContent, state.getAttribute('data-state')]).toEqual(['cutting', 'cutting']);
    nowMs.value = 9000;
    await turn();
    expect([state.textContent, state.getAttribute('data-state')]).toEqual(['idle', 'idle']);
  });

  it('follows a tool that is pressed', async () => {
    join(ada, bo);
    await turn();
    expect(row().className).toBe('person selected');
    row().click();
    await turn();
    expect(picture.followed).toBe(1);
    expect(row().getAttribute('aria-pressed')).toBe('true');
    expect(row().textContent).toContain('idle · following');
    row().click();
    expect(picture.followed).toBeNull();
  });

  it("edits the viewer's own name in place", async () => {
    join(grace);
    await turn();
    const edit = async (): Promise<HTMLInputElement> => {
      lists.querySelector<HTMLElement>('.chip.own')!.click();
      await turn();
      return lists.querySelector('input')!;
    };
    const write = (input: HTMLInputElement, text: string): void => {
      input.value = text;
      input.dispatchEvent(new Event('input'));
    };
    let input = await edit();
    expect([input.value, document.activeElement]).toEqual(['Grace', input]);
    write(input, ' Hopper ');
    model.participants.setList([ada, grace]); // a new list does not end the edit
    await turn();
    expect(lists.querySelector('input')).toBe(input);
    lists.querySelector('form')!.dispatchEvent(new Event('submit', { cancelable: true }));
    await turn();
    expect(renamed.mock.calls).toEqual([['Hopper']]);
    expect(watchers()).toEqual(['Grace (you)']);
    input = await edit();
    write(input, 'Nobody');
    input.dispatchEvent(new KeyboardEvent('keydown', { key: 'Escape' }));
    await turn();
    expect(renamed).toHaveBeenCalledTimes(1);
    expect(lists.querySelector('input')).toBeNull();
  });
});

describe('the chosen participant', () => {
  it('is the first one until another one is chosen, or leaves', () => {
    expect(choice.selected).toBeNull();
    join(ada, bo);
    expect(choice.selected).toBe(1);
    choice.press(3);
    expect([choice.selected, choice.followed]).toEqual([3, 3]);
    model.participants.setList([ada]);
    expect([choice.selected, choice.followed]).toEqual([1, null]);
    model.participants.setList([]);
    expect(choice.selected).toBeNull();
  });

  it('is each tool in turn, then none', () => {
    join(ada, bo);
    const followed = [1, 2, 3].map(() => {
      choice.followNext();
      return choice.followed;
    });
    expect(followed).toEqual([1, 3, null]);
    expect(choice.selected).toBe(3);
  });
});
