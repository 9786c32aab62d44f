// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { signal } from '@preact/signals';
import { h } from 'preact';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { InviteDialog } from '../src/ui/invite';
import { buttonOf, enter, press, show } from './support/shown';
import { turn } from './support/turn';

const LINK = '/?session=demo#invite=kerf_0123456789ab_0123456789abcdef0123456789abcdef';

describe('the dialog of an invitation', () => {
  let root: HTMLElement;
  let respond: ReturnType<typeof vi.fn<typeof fetch>>;

  beforeEach(() => {
    vi.stubGlobal('navigator', { language: 'en' }); // no clipboard, as on plain HTTP
    vi.stubGlobal('location', { origin: 'https://kerf.example', pathname: '/', search: '' });
    answerWith(201, { link: LINK });
    root = show(h(InviteDialog, { session: 'demo', isOpen: signal(false) }));
  });
  afterEach(() => vi.unstubAllGlobals());

  function answerWith(status: number, body: unknown): void {
    respond = vi.fn<typeof fetch>(() =>
      Promise.resolve(new Response(JSON.stringify(body), { status })),
    );
    vi.stubGlobal('fetch', respond);
  }
  const one = (name: string): HTMLElement => root.querySelector<HTMLElement>(`.${name}`)!;
  const roles = (): HTMLInputElement[] => [
    ...root.querySelectorAll<HTMLInputElement>('input[type=radio]'),
  ];
  const note = (): string => one('quiet[role=status]').textContent;
  const link = (): HTMLInputElement => one('invite-link') as HTMLInputElement;
  const create = (): Promise<void> => press(buttonOf(root, 'Create link'));

  it('asks for a sculptor for a week at first', async () => {
    expect(roles().map(({ value, checked }) => [value, checked])).toEqual([
      ['watcher', false],
      ['sculptor', true],
      ['owner', false],
    ]);
    await create();
    expect(respond.mock.calls[0]![0]).toBe('/v1/sessions/demo/invitations?role=sculptor&hours=168');
  });

  it('asks for the role and the time that are chosen', async () => {
    roles()[0]!.dispatchEvent(new Event('change'));
    await enter(one('invite-time') as HTMLSelectElement, '24');
    await create();
    expect(respond.mock.calls[0]![0]).toBe('/v1/sessions/demo/invitations?role=watcher&hours=24');
  });

  it('shows the link and its code once, and forgets them when it is closed', async () => {
    expect(link().hidden).toBe(true);
    await create();
    await vi.waitFor(() => expect(one('invite-code').innerHTML).toMatch(/^<svg/), 30_000);
    expect(one('invite-code').hidden).toBe(false);
    expect(link().value).toBe(`https://kerf.example${LINK}`);
    expect(note()).toMatch(
      /Anyone with this link gets this role\. It expires on .*shown only once/,
    );
    root.querySelector('dialog')!.dispatchEvent(new Event('close'));
    await turn();
    expect([link().value, link().hidden]).toEqual(['', true]);
    expect([one('invite-code').hidden, note()]).toEqual([true, '']);
  });

  it('says why there is no link', async () => {
    answerWith(403, { error: { code: 'forbidden', reason: 'a sculptor may not invite' } });
    await create();
    await vi.waitFor(() => expect(note()).toBe('A sculptor may not invite.'));
    expect(link().hidden).toBe(true);
  });
});
