// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import golden from '../../tests/wire/golden/programs.json';
import { SessionModel } from '../src/model/session';
import type { ProgramsPanelHost } from '../src/ui/programs/host';
import { ProgramsPanel } from '../src/ui/programs/programs_panel';
import type { Shell } from '../src/ui/shell';
import { parseControl } from '../src/wire/control';
import type { ProgramInfo } from '../src/wire/types';
import { emptyShell } from './support/shown';

type Json = Record<string, unknown>;

const PROGRAM: Json = golden.programs[0]!;

/** The programs of a server that answers over HTTP and pushes to the model. */
class FakePrograms {
  readonly model = new SessionModel();
  readonly asked: string[] = [];
  programs: Json[] = [];
  alarms: Json[] = [];
  targets: Json[] = [];

  readonly fetch = (address: string, { method }: { method: string }): Promise<unknown> => {
    const path = address.replace('/v1/sessions/demo/programs', '');
    if (path.endsWith('/targets')) return answer(200, { targets: this.targets });
    if (path.startsWith('/v1/')) return answer(200, {}); // strokes: none
    this.asked.push(`${method} ${path}`);
    if (method === 'POST') {
      const error = { reason: 'G99 is not supported', line: 2, word: 'G99' };
      return answer(400, { error });
    }
    const all = this.programs.map((program) => ({
      ...program,
      alarms: Number(program['alarm_count']) > 0 ? this.alarms : [],
    }));
    if (path === '') return answer(200, { programs: all });
    const id = Number(path.split('/')[1]);
    if (path.endsWith('/source')) return answer(200, `source of ${id}`);
    return answer(200, all.find((program: Json) => program['id'] === id) ?? {});
  };

  push(): void {
    const message = parseControl(JSON.stringify({ type: 'programs', programs: this.programs }));
    if (message.ok && message.value) this.model.apply(message.value);
  }
}

function answer(status: number, body: unknown): Promise<unknown> {
  const snapshot = structuredClone(body);
  return Promise.resolve({
    ok: status === 200,
    json: () => Promise.resolve(snapshot),
    text: () => Promise.resolve(snapshot),
  });
}

function program(id: number, more: Json = {}): Json {
  const plain = { name: `${id}.ngc`, alarm_count: 0, line: 1, motions_done: 10, motions: 100 };
  return { ...PROGRAM, ...plain, id, state: 'running', ...more };
}

function alarm(amount: number, toLine: number): Json {
  const place = { tool: 1, unit: 'mm', tip_mm: [1, 2, 3] };
  return { kind: 'rapid', from_line: 14, to_line: toLine, amount, ...place };
}

const wait = (ms: number): Promise<unknown> => vi.advanceTimersByTimeAsync(ms);

describe('the panel of programs', () => {
  let server: FakePrograms;
  const all = <E extends HTMLElement>(name: string): E[] => [
    ...document.querySelectorAll<E>(`.${name}`),
  ];
  const rows = (): HTMLElement[] => all('program-row-button');
  const text = (): string => all('program-text')[0]!.textContent;
  const alarms = (): HTMLElement[] => [
    ...document.querySelectorAll<HTMLElement>('.program-alarms button'),
  ];
  const menu = (label: string): HTMLSelectElement =>
    document.querySelector(`select[aria-label="${label}"]`)!;

  function choose(list: HTMLSelectElement, value: string): void {
    list.value = value;
    list.dispatchEvent(new Event('change'));
  }

  async function send(name: string, content: string): Promise<void> {
    const input = all<HTMLInputElement>('program-file')[0]!;
    const files = [{ name, text: () => Promise.resolve(content) }];
    Object.defineProperty(input, 'files', { value: files, configurable: true });
    input.dispatchEvent(new Event('change'));
    await wait(500);
  }

  beforeEach(() => {
    vi.useFakeTimers();
    document.body.replaceChildren();
    server = new FakePrograms();
    vi.stubGlobal('fetch', server.fetch);
  });
  afterEach(async () => {
    await wait(1000); // answers that the panel waits for
    vi.useRealTimers();
    vi.unstubAllGlobals();
  });

  /** Shows the panel. */
  function show(more: Partial<ProgramsPanelHost>): Shell {
    const shell = emptyShell();
    const panel = new ProgramsPanel({ model: server.model, session: 'demo', shell, ...more });
    shell.show(null, panel.view());
    panel.toggle();
    return shell;
  }

  async function open(...programs: Json[]): Promise<void> {
    server.programs = programs;
    server.push();
    show({});
    await wait(1000);
  }

  it('plays the cuts of a program that has ended', async () => {
    const replayed: number[] = [];
    server.programs = [program(7)];
    server.push();
    const replay = (one: ProgramInfo): number => replayed.push(one.id);
    const shell = show({ replay });
    await wait(1000);
    const button = (): HTMLButtonElement => all<HTMLButtonElement>('program-play')[0]!;
    expect(button().textContent).toBe('Pause');
    server.programs = [program(7, { state: 'finished', motions_done: 100 })];
    server.push();
    await wait(1000);
    expect(button().textContent).toBe('Play the cuts');
    button().click();
    expect(replayed).toEqual([7]);
    expect(shell.isProgramsOpen.value).toBe(false);
  });

  it('shows a rejected file until the user selects a program', async () => {
    await open(program(3));
    expect(text()).toContain('source of 3');
    await send('new.ngc', 'G1 X1\nG99 X2');
    for (let n = 0; n < 3; n += 1) {
      expect(text()).toContain('G99 X2');
      expect(all('marked')).toHaveLength(1);
      expect(rows().map((row) => row.getAttribute('aria-pressed'))).toEqual(['false']);
      server.programs = [program(3, { motions_done: 20 + n })];
      server.push();
      await wait(250);
    }
    rows()[0]!.click();
    await wait(250);
    expect(text()).toContain('source of 3');
    expect(rows()[0]!.getAttribute('aria-pressed')).toBe('true');
  });

  it('sends the chosen control, and states the language of a program', async () => {
    await open(program(3, { read_as: 'Haas: line 3 has G154' }));
    expect(all('program-figures')[0]!.textContent).toContain('Read as Haas: line 3 has G154.');
    choose(menu('CNC control of the program'), 'haas');
    await send('new.nc', 'G1');
    expect(server.asked.filter((asked) => asked.startsWith('POST'))).toEqual([
      expect.stringContaining('&dialect=haas&queue=1'),
    ]);
  });

  it('watches for gouges into the first part, unless the user wants none', async () => {
    server.targets = [{ name: 'a part.stl' }, { name: 'b.stl' }];
    await open(program(3));
    const query = async (): Promise<string | undefined> => {
      server.asked.length = 0;
      await send('new.nc', 'G1');
      return server.asked.find((asked) => asked.startsWith('POST'));
    };
    expect(await query()).toContain('&target=a%20part.stl&target_tolerance_mm=0.05');
    choose(menu('Part the program makes'), '');
    expect(await query()).not.toContain('target');
  });

  it('names the part, and leads to the deepest place of a gouge', async () => {
    server.alarms = [{ ...alarm(0.3, 14), kind: 'gouge', unit: 'mm', at_mm: [7, 8, 9] }];
    await open(program(3, { alarm_count: 1, target: 'part.stl', target_tolerance_mm: 0.05 }));
    expect(all('program-figures')[0]!.textContent).toContain(
      'Watching for gouges into part.stl deeper than 0.05 mm.',
    );
    const [button] = alarms();
    expect(button!.textContent).toBe('Gouge into the part, 0.3 mm: line 14, at X 7.0 Y 8.0 Z 9.0');
  });

  it('shows an alarm as far as the program has come, and asks once a second', async () => {
    server.alarms = [alarm(1, 14)];
    await open(program(3, { alarm_count: 1 }));
    const [button] = alarms();
    expect(button!.textContent).toContain('1 mm: line 14,');
    server.asked.length = 0;
    for (let n = 1; n <= 20; n += 1) {
      server.alarms = [alarm(1 + n, 14 + n)];
      server.programs = [program(3, { alarm_count: 1, motions_done: 10 + n })];
      server.push();
      await wait(250);
    }
    expect(server.asked.length).toBeGreaterThan(3);
    expect(server.asked.length).toBeLessThan(7);
    expect(button!.textContent).toMatch(/(18|19|20|21) mm/);
    server.alarms = [alarm(40, 99)];
    server.programs = [program(3, { alarm_count: 1, motions_done: 100, state: 'finished' })];
    server.push();
    await wait(1500);
    expect(alarms()).toHaveLength(1);
    expect(alarms()[0]).toBe(button);
    expect(button!.textContent).toContain('40 mm: lines 14–99,');
    server.asked.length = 0;
    server.push();
    await wait(5000);
    expect(server.asked).toEqual([]); // nothing has changed
  });

  it('lists the alarms of the selected program only', async () => {
    server.alarms = [alarm(1, 14), alarm(2, 30)];
    await open(program(3, { alarm_count: 2 }));
    expect(alarms()).toHaveLength(2);
    server.programs.push(program(4, { alarm_count: 1 })); // its details are not known yet
    server.push();
    await wait(200);
    server.alarms = [alarm(7, 50)];
    rows()[1]!.click();
    await wait(500);
    expect(alarms().map(({ textContent }) => textContent)).toEqual([
      expect.stringContaining('7 mm: lines 14–50,'),
    ]);
  });

  it('keeps the rows while their texts change', async () => {
    await open(program(3), program(4));
    const [first, second] = rows();
    server.programs = [program(3, { state: 'paused', line: 77 }), program(4, { alarm_count: 2 })];
    server.push();
    await wait(250);
    expect(rows()[0]).toBe(first);
    expect(rows()[1]).toBe(second);
    expect(first!.textContent).toBe('3.ngcpaused at line 77');
    expect(first!.getAttribute('data-state')).toBe('paused');
    expect(second!.textContent).toContain('2 alarms');
    server.programs = [program(3, { state: 'finished' }), program(4), program(5)];
    server.push();
    await wait(250);
    expect(rows().map((row) => row.textContent.slice(0, 5))).toEqual(['4.ngc', '5.ngc', '3.ngc']);
    expect(rows()[0]).toBe(second);
    expect(rows()[2]).toBe(first);
    server.model.programs.clear();
    await wait(250);
    expect(rows()).toEqual([]);
  });

  it('keeps the speed that is being chosen while the server pushes another one', async () => {
    await open(program(3, { pace: 'feed', speed: 1 }));
    const speed = menu('Speed');
    speed.dispatchEvent(new Event('focus'));
    choose(speed, '2');
    server.programs = [program(3, { pace: 'feed', speed: 1, motions_done: 11 })];
    server.push();
    await wait(0);
    expect(speed.value).toBe('2');
    expect(server.asked).toContain('PATCH /3?speed=2');
    server.programs = [program(3, { pace: 'feed', speed: 3 })];
    server.push();
    speed.dispatchEvent(new Event('blur'));
    await wait(0);
    expect(speed.value).toBe('3');
    expect(speed.selectedOptions[0]!.textContent).toBe('× 3');
  });

  it('requests nothing while it is closed', async () => {
    server.alarms = [alarm(1, 14)];
    await open(program(3, { alarm_count: 1 }));
    document.querySelector<HTMLElement>('.programs header button')!.click();
    server.asked.length = 0;
    for (let n = 1; n <= 5; n += 1) {
      server.programs = [program(3, { alarm_count: 1, motions_done: 10 + n })];
      server.push();
      await wait(1000);
    }
    expect(server.asked).toEqual([]);
    expect(all('programs')[0]!.hidden).toBe(true);
  });
});
