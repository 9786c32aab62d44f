// SPDX-License-Identifier: Apache-2.0
// The dialog by which an owner makes an invitation: a role, a time, and the link to send.

import { language, t } from '../strings';
import { makeInvitation } from '../link/invitation';
import type { InvitedRole } from '../link/invitation';
import { copyText, h, setText } from './dom';
import { sentence } from './format';

const ROLES: readonly [InvitedRole, string, string][] = [
  ['watcher', t('Watcher'), t('can view and download the block')],
  ['sculptor', t('Sculptor'), t('can also carve and run programs')],
  ['owner', t('Owner'), t('can also invite, mute and remove participants, and close the session')],
];
const TIMES: readonly [string, number][] = [
  [t('for a day'), 24],
  [t('for a week'), 7 * 24],
  [t('for a month'), 30 * 24],
];

/** A square code of the link, for the camera of a phone. Its code is loaded when it is needed. */
async function showCode(place: HTMLElement, address: string): Promise<void> {
  const { renderSVG } = await import('uqr');
  place.innerHTML = renderSVG(address, { border: 3 }); // only of squares
  place.hidden = false;
}

function untilText(hours: number): string {
  const format = new Intl.DateTimeFormat(language, { dateStyle: 'medium', timeStyle: 'short' });
  return format.format(Date.now() + hours * 3_600_000);
}

export function inviteDialog(session: string): HTMLDialogElement {
  let role: InvitedRole = 'sculptor';
  const choices = ROLES.map(([value, name, may]) => {
    const input = h('input', { type: 'radio', name: 'invited-role', value });
    input.checked = value === role;
    input.addEventListener('change', () => (role = value));
    return h('label', { class: 'invite-role' }, input, h('b', {}, name), h('small', {}, may));
  });
  const time = h(
    'select',
    { class: 'invite-time', 'aria-label': t('Link is valid') },
    ...TIMES.map(([text, hours]) => h('option', { value: String(hours) }, text)),
  );
  time.value = String(TIMES[1]![1]);
  const link = h('input', {
    class: 'invite-link',
    readonly: '',
    hidden: '',
    'aria-label': t('Invitation link'),
  });
  const code = h('div', {
    class: 'invite-code',
    role: 'img',
    'aria-label': t('Invitation link as a QR code'),
    hidden: '',
  });
  const note = h('p', { class: 'quiet', role: 'status' });
  const make = h('button', { type: 'button', class: 'button' }, t('Create link'));
  make.addEventListener('click', () => {
    makeInvitation(session, role, Number(time.value)).then(
      (address) => {
        link.value = address;
        link.hidden = false;
        link.select();
        const end = t('It expires on {0}', untilText(Number(time.value)));
        setText(
          note,
          t('Anyone with this link gets this role. {0}. Copy it now: it is shown only once.', end),
        );
        showCode(code, address).catch((problem: unknown) => console.warn('No QR code:', problem));
        copyText(address, () => setText(note, t('Copied. Send it to your guest. {0}.', end)));
      },
      (problem: unknown) => setText(note, sentence((problem as Error).message)),
    );
  });
  const close = h('button', { type: 'button', class: 'button quiet-button' }, t('Close'));
  const dialog = h(
    'dialog',
    { class: 'help invite', 'aria-label': t('Invite') },
    h('h2', {}, t('Invite')),
    h('div', { role: 'radiogroup', 'aria-label': t('Role') }, ...choices),
    h('p', { class: 'invite-make' }, make, time, close),
    link,
    code,
    note,
  );
  close.addEventListener('click', () => dialog.close());
  dialog.addEventListener('close', () => {
    link.value = '';
    link.hidden = true;
    code.hidden = true;
    code.replaceChildren();
    setText(note, '');
  });
  return dialog;
}
