// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { signal } from '@preact/signals';
import type { Signal } from '@preact/signals';
import { h } from 'preact';
import { afterEach, beforeEach, describe, expect, it } from 'vitest';
import type { Version } from '../src/link/history';
import { SessionModel } from '../src/model/session';
import { Versions } from '../src/ui/timeline/versions';
import type { VersionActions, VersionsProps } from '../src/ui/timeline/versions';
import type { Welcome } from '../src/wire/types';
import { show } from './support/shown';
import { turn } from './support/turn';

const HALF: Version = {
  name: 'Half done',
  record: 12,
  time_ms: 0,
  author: 'Ada',
  may_change: true,
};

describe('the versions of the timeline', () => {
  let calls: unknown[][];
  let versions: Signal<readonly Version[]>;
  let model: SessionModel;
  let element: HTMLElement;

  beforeEach(() => {
    calls = [];
    versions = signal<readonly Version[]>([HALF]);
    model = new SessionModel();
    const names = ['go', 'name', 'rename', 'remove', 'branch'] as const;
    const actions = Object.fromEntries(
      names.map((name) => [name, (...values: unknown[]) => void calls.push([name, ...values])]),
    );
    const props: VersionsProps = {
      model,
      records: {
        get versions() {
          return versions.value;
        },
      },
      actions: actions as unknown as VersionActions,
      proposed: () => 'demo-12',
    };
    element = show(h(Versions, props));
  });
  afterEach(() => element.remove());

  const button = (label: string): HTMLButtonElement =>
    [...element.querySelectorAll('button')].find(({ textContent }) => textContent === label)!;
  const input = (): HTMLInputElement => element.querySelector('input')!;
  const list = (): HTMLSelectElement => element.querySelector('select')!;
  const form = (): HTMLFormElement => element.querySelector('form')!;

  async function choose(name: string): Promise<void> {
    list().value = name;
    list().dispatchEvent(new Event('change'));
    await turn();
  }
  async function press(label: string): Promise<void> {
    button(label).click();
    await turn();
  }
  async function write(text: string): Promise<void> {
    input().value = text;
    input().dispatchEvent(new Event('input'));
    form().dispatchEvent(new Event('submit', { cancelable: true }));
    await turn();
  }

  it('can be renamed and deleted once one is chosen', async () => {
    expect(button('Rename').disabled).toBe(true);
    expect(button('Delete').disabled).toBe(true);
    await choose('Half done');
    expect(button('Rename').disabled).toBe(false);
    await press('Rename');
    expect(input().value).toBe('Half done');
    await write(' Roughed ');
    await press('Delete');
    expect(calls).toEqual([
      ['go', 12],
      ['rename', 'Half done', 'Roughed'],
      ['remove', 'Half done'],
    ]);
  });

  it('of other participants can be visited and not changed', async () => {
    versions.value = [{ ...HALF, may_change: false }];
    await choose('Half done');
    expect(calls).toEqual([['go', 12]]);
    expect(button('Rename').disabled).toBe(true);
    expect(button('Delete').disabled).toBe(true);
  });

  it('cannot be changed without the right', async () => {
    model.apply({ type: 'welcome', may: [], participants: [] } as unknown as Welcome);
    await turn();
    for (const label of ['Rename', 'Delete', 'Save a version', 'Branch from here'])
      expect(button(label).hidden).toBe(true);
  });

  it('follow the list of the server, which may lose the chosen one', async () => {
    await choose('Half done');
    versions.value = [{ ...HALF, name: 'Roughed' }];
    await turn();
    expect([...list().options].map(({ value }) => value)).toEqual(['', 'Roughed']);
    expect(list().value).toBe('');
    expect(button('Rename').disabled).toBe(true);
  });

  it('have a form that takes the focus, and gives it back', async () => {
    expect(form().hidden).toBe(true);
    await press('Branch from here');
    expect(form().hidden).toBe(false);
    expect(input().value).toBe('demo-12');
    expect(document.activeElement).toBe(input());
    form().dispatchEvent(new KeyboardEvent('keydown', { key: 'Escape' }));
    await turn();
    expect(form().hidden).toBe(true);
    expect(document.activeElement).toBe(button('Branch from here'));
    expect(calls).toEqual([]);
    await press('Save a version');
    await write('Roughed');
    expect(calls).toEqual([['name', 'Roughed']]);
  });
});
