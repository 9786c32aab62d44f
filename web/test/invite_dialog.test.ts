// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { inviteDialog } from '../src/ui/invite';
import type { FakeElement } from './support/fake_dom';
import { stubPage } from './support/fake_dom';

const LINK = '/?session=demo#invite=kerf_0123456789ab_0123456789abcdef0123456789abcdef';

describe('the dialog of an invitation', () => {
  let dialog: FakeElement;
  let respond: ReturnType<typeof vi.fn<typeof fetch>>;

  beforeEach(() => {
    stubPage();
    vi.stubGlobal('navigator', {}); // no clipboard, as on plain HTTP
    vi.stubGlobal('location', { origin: 'https://kerf.example', pathname: '/', search: '' });
    answerWith(201, { link: LINK });
    dialog = inviteDialog('demo') as unknown as FakeElement;
  });
  afterEach(() => vi.unstubAllGlobals());

  function answerWith(status: number, body: unknown): void {
    respond = vi.fn<typeof fetch>(() =>
      Promise.resolve(new Response(JSON.stringify(body), { status })),
    );
    vi.stubGlobal('fetch', respond);
  }
  const one = (name: string): FakeElement => dialog.all(name)[0]!;
  const roles = (): FakeElement[] => dialog.all('invite-role').map((role) => role.children[0]!);
  const note = (): string => dialog.all('quiet')[0]!.textContent;
  const create = (): void => dialog.all('button')[0]!.click();

  it('asks for a sculptor for a week at first', async () => {
    expect(roles().map(({ value, checked }) => [value, checked])).toEqual([
      ['watcher', false],
      ['sculptor', true],
      ['owner', false],
    ]);
    create();
    await vi.waitFor(() => expect(respond).toHaveBeenCalledOnce());
    expect(respond.mock.calls[0]![0]).toBe('/v1/sessions/demo/invitations?role=sculptor&hours=168');
  });

  it('asks for the role and the time that are chosen', async () => {
    roles()[0]!.dispatch('change');
    one('invite-time').value = '24';
    create();
    await vi.waitFor(() => expect(respond).toHaveBeenCalledOnce());
    expect(respond.mock.calls[0]![0]).toBe('/v1/sessions/demo/invitations?role=watcher&hours=24');
  });

  it('shows the link and its code once, and forgets them when it is closed', async () => {
    expect(one('invite-link').hidden).toBe(true);
    create();
    const code = one('invite-code');
    await vi.waitFor(() => expect(code.hidden).toBe(false));
    expect((code as unknown as { innerHTML: string }).innerHTML).toMatch(/^<svg/);
    expect(one('invite-link').value).toBe(`https://kerf.example${LINK}`);
    expect(note()).toMatch(
      /Anyone with this link gets this role\. It expires on .*shown only once/,
    );
    dialog.dispatch('close');
    expect([one('invite-link').value, one('invite-link').hidden]).toEqual(['', true]);
    expect([code.hidden, note()]).toEqual([true, '']);
  });

  it('says why there is no link', async () => {
    answerWith(403, { error: { code: 'forbidden', reason: 'a sculptor may not invite' } });
    create();
    await vi.waitFor(() => expect(note()).toBe('A sculptor may not invite.'));
    expect(one('invite-link').hidden).toBe(true);
  });
});
