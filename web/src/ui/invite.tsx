// SPDX-License-Identifier: Apache-2.0
// The dialog by which an owner makes an invitation: a role, a time, and the link to send.

import { signal } from '@preact/signals';
import type { Signal } from '@preact/signals';
import { useMemo } from 'preact/hooks';
import { language, t } from '../strings';
import { makeInvitation } from '../link/invitation';
import type { InvitedRole } from '../link/invitation';
import { copyText } from './clipboard';
import { Dialog } from './dialog';
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

function untilText(hours: number): string {
  const format = new Intl.DateTimeFormat(language, { dateStyle: 'medium', timeStyle: 'short' });
  return format.format(Date.now() + hours * 3_600_000);
}

/** An invitation that is being made. */
class InviteState {
  readonly role = signal<InvitedRole>('sculptor');
  readonly hours = signal(TIMES[1]![1]);
  /** The link; empty until it was created. It is shown only once. */
  readonly link = signal('');
  /** A square code of the link as SVG, for the camera of a phone; empty until it is drawn. */
  readonly code = signal('');
  readonly note = signal('');

  constructor(private readonly session: string) {}

  async create(): Promise<void> {
    const { role, hours, link, note } = this;
    try {
      link.value = await makeInvitation(this.session, role.value, hours.value);
    } catch (problem) {
      note.value = sentence((problem as Error).message);
      return;
    }
    const end = t('It expires on {0}', untilText(hours.value));
    note.value = t(
      'Anyone with this link gets this role. {0}. Copy it now: it is shown only once.',
      end,
    );
    this.draw_().catch((problem: unknown) => console.warn('No QR code:', problem));
    copyText(link.value, () => {
      note.value = t('Copied. Send it to your guest. {0}.', end);
    });
  }

  forget(): void {
    this.link.value = this.code.value = this.note.value = '';
  }

  /** The code that draws is loaded when it is needed. */
  private async draw_(): Promise<void> {
    const address = this.link.value;
    const { renderSVG } = await import('uqr');
    if (this.link.value === address) this.code.value = renderSVG(address, { border: 3 });
  }
}

function RoleChoice({ role }: { role: Signal<InvitedRole> }) {
  return (
    <div role="radiogroup" aria-label={t('Role')}>
      {ROLES.map(([value, name, may]) => (
        <label key={value} class="invite-role">
          <input
            type="radio"
            name="invited-role"
            value={value}
            checked={role.value === value}
            onChange={() => (role.value = value)}
          />
          <b>{name}</b>
          <small>{may}</small>
        </label>
      ))}
    </div>
  );
}

function TimeChoice({ hours }: { hours: Signal<number> }) {
  return (
    <select
      class="invite-time"
      aria-label={t('Link is valid')}
      value={String(hours.value)}
      onChange={({ currentTarget }) => (hours.value = Number(currentTarget.value))}
    >
      {TIMES.map(([text, value]) => (
        <option key={value} value={String(value)}>
          {text}
        </option>
      ))}
    </select>
  );
}

/** The link and its code, once they are there. */
function Link({ link, code }: { link: string; code: string }) {
  return (
    <>
      <input
        class="invite-link"
        readOnly
        hidden={link === ''}
        aria-label={t('Invitation link')}
        value={link}
        ref={(input) => {
          if (link !== '') input?.select();
        }}
      />
      <div
        class="invite-code"
        role="img"
        aria-label={t('Invitation link as a QR code')}
        hidden={code === ''}
        dangerouslySetInnerHTML={{ __html: code }} // squares only
      />
    </>
  );
}

export function InviteDialog({ session, isOpen }: { session: string; isOpen: Signal<boolean> }) {
  const state = useMemo(() => new InviteState(session), [session]);
  return (
    <Dialog class="help invite" label={t('Invite')} isOpen={isOpen} closed={() => state.forget()}>
      <h2>{t('Invite')}</h2>
      <RoleChoice role={state.role} />
      <p class="invite-make">
        <button type="button" class="button" onClick={() => void state.create()}>
          {t('Create link')}
        </button>
        <TimeChoice hours={state.hours} />
        <button type="button" class="button quiet-button" onClick={() => (isOpen.value = false)}>
          {t('Close')}
        </button>
      </p>
      <Link link={state.link.value} code={state.code.value} />
      <p class="quiet" role="status">
        {state.note.value}
      </p>
    </Dialog>
  );
}
