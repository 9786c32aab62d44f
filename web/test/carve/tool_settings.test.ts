// SPDX-License-Identifier: Apache-2.0
import { signal } from '@preact/signals';
import { beforeEach, describe, expect, it, vi } from 'vitest';
import type { Hand } from '../../src/carve/hand';
import { ToolSettings } from '../../src/carve/tool_settings';
import type { NewTool } from '../../src/model/tool_sizes';
import type { ToolInfo, Welcome } from '../../src/wire/types';

const BALL: ToolInfo = { id: 1, shape: 'ball', diameter_mm: 6, length_mm: 30 };
const CUTTER: ToolInfo = { id: 2, shape: 'apt', d_mm: 6, h_mm: 30 };

describe('tool settings', () => {
  const tools = signal<ToolInfo[]>([]);
  let made: NewTool[];
  let answers: ((tool: ToolInfo | Error) => void)[];
  let said: string[];
  let changes: number;
  let asked: unknown[];
  let taken: number[];
  let settings: ToolSettings;

  beforeEach(() => {
    tools.value = [BALL, CUTTER];
    [made, answers, said, asked, taken] = [[], [], [], [], []];
    changes = 0;
    const hand = {
      settings: { mode: 'surface', depthMm: 1, leanMaxRad: 0 },
      drag: { strength: 'off' },
      sampler: { ask: (request: unknown) => asked.push(request) },
      takeTool: (tool: ToolInfo) => taken.push(tool.id),
      hoverAgain: () => undefined,
    };
    settings = new ToolSettings(hand as unknown as Hand, {
      isJoined: () => true,
      color: () => '#ffffff',
      changes: () => (changes += 1),
      tools: () => tools.value,
      mayMake: () => true,
      makeTool: (tool) => {
        made.push(tool);
        return new Promise((resolve, reject) =>
          answers.push((answer) => {
            if (answer instanceof Error) reject(answer);
            else resolve(answer);
          }),
        );
      },
      say: (text) => said.push(text),
    });
    settings.prepare({ pitch_mm: 0.25, tools: tools.value } as Welcome);
  });

  async function answer(id: number): Promise<void> {
    const tool = { id, ...made.at(-1)! };
    tools.value = [...tools.value, tool];
    answers.at(-1)!(tool);
    await vi.waitFor(() => expect(settings.tool?.id).toBe(id));
  }

  it('make a wider tool of the same shape, and take it after the stroke before it', async () => {
    settings.resize(1);
    expect(made).toEqual([{ shape: 'ball', diameter_mm: 7, length_mm: 30 }]);
    expect(settings.wish?.diameter_mm).toBe(7);
    expect(settings.tool?.id).toBe(1);
    const before = changes;
    await answer(3);
    expect(changes).toBe(before + 1);
    expect(asked).toEqual([{ type: 'tool', tool: 3 }]);
    expect(taken.at(-1)).toBe(3);
  });

  it('take a tool that the session has without making it', () => {
    tools.value = [...tools.value, { id: 9, shape: 'ball', diameter_mm: 7, length_mm: 30 }];
    settings.resize(1);
    expect(settings.tool?.id).toBe(9);
    expect(made).toEqual([]);
  });

  it('make only the last of the sizes that are asked for meanwhile', async () => {
    settings.resize(1);
    settings.resize(1);
    settings.resize(1);
    expect(settings.wish?.diameter_mm).toBe(9);
    tools.value = [...tools.value, { id: 3, ...made[0]! }];
    answers[0]!(tools.value[2]!);
    await vi.waitFor(() => expect(made).toHaveLength(2));
    expect(made[1]!.diameter_mm).toBe(9);
    await answer(4);
    expect(taken).not.toContain(3);
  });

  it('keep the tool, and say why, when none is made', async () => {
    settings.chooseShape('cone_end');
    answers[0]!(new Error('a session has at most 255 tools'));
    await vi.waitFor(() => expect(said).toEqual(['a session has at most 255 tools']));
    expect(settings.tool?.id).toBe(1);
    expect(settings.wish?.shape).toBe('ball');
    settings.resize(-1);
    expect(made.at(-1)?.shape).toBe('ball');
  });

  it('give up a tool that is being made when another is chosen', async () => {
    settings.resize(1);
    settings.chooseTool(2);
    tools.value = [...tools.value, { id: 3, ...made[0]! }];
    answers[0]!(tools.value[2]!);
    await Promise.resolve();
    await Promise.resolve();
    expect(settings.tool?.id).toBe(2);
    settings.resize(1);
    expect(said).toEqual(['This tool has one size only. Choose a shape to change it.']);
    settings.chooseShape('flat');
    expect(made.at(-1)).toEqual({ shape: 'flat', diameter_mm: 6, length_mm: 30 });
  });
});
