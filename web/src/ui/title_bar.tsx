// SPDX-License-Identifier: Apache-2.0
// The bar at the top: the scene's name and who does what to it, the viewer's role, the
// connection.

import { useSignalEffect } from '@preact/signals';
import type { ReadonlySignal } from '@preact/signals';
import type { ComponentChildren } from 'preact';
import { useMemo } from 'preact/hooks';
import { t } from '../strings';
import { roleName } from '../strings/names';
import { pageAddress } from '../link/request';
import { headlineOf } from '../model/headline';
import { Newcomers } from '../model/newcomers';
import type { Participant } from '../model/participants';
import type { SessionModel } from '../model/session';
import { Badge } from './badge';

/** The bar, with the name of the product, which is a link if `home` is true. */
export function Bar({ home, children }: { home: boolean; children: ComponentChildren }) {
  const brand = (
    <>
      <img src="./icon.svg" alt="" width="28" height="28" />
      <span class="brand-name">Kerf</span>
    </>
  );
  return (
    <header class="bar">
      {home ? (
        <a
          class="brand"
          href="?list"
          aria-label={t('Kerf: all sessions')}
          onClick={({ currentTarget }) => (currentTarget.href = pageAddress('?list'))}
        >
          {brand}
        </a>
      ) : (
        <span class="brand">{brand}</span>
      )}
      {children}
    </header>
  );
}

interface HeadlineProps {
  model: SessionModel;
  session: string;
  nowMs: ReadonlySignal<number>;
}

/** Who does what to the block, how far it is, and who has just joined. */
function Headline({ model, session, nowMs }: HeadlineProps) {
  const newcomers = useMemo(() => new Newcomers(), []);
  const { welcome, participants } = model;
  const { who: carving, far } = headlineOf(model, session, nowMs.value);
  const isSelf = (one: Participant): boolean =>
    one.info.participant === welcome?.participant ||
    participants.isAgentOf(welcome?.participant, one);
  const newcomer = newcomers.update(participants.all(), isSelf, nowMs.value);
  const joins = newcomer === '' ? '' : t('{0} has joined', newcomer);
  const who = [carving, joins].filter((text) => text !== '').join(' · ');
  return (
    <p
      class="headline"
      hidden={who === '' || model.state?.at !== undefined}
      title={far === '' ? who : `${who}, ${far}`}
    >
      <span class="headline-who">{who}</span>
      <span class="headline-far">{far}</span>
    </p>
  );
}

export function TitleBar({ model, session, nowMs }: HeadlineProps) {
  const { welcome, participants } = model;
  const name = welcome?.name ?? session;
  useSignalEffect(() => {
    document.title = `${model.welcome?.name ?? session} · Kerf`;
  });
  const own = welcome ? participants.get(welcome.participant)?.info.role : undefined;
  const role = own ?? welcome?.role;
  return (
    <Bar home>
      <div class="titles">
        <h1 class="session-name" title={session}>
          {name}
        </h1>
        <Headline model={model} session={session} nowMs={nowMs} />
      </div>
      <span class="role" hidden={role === undefined}>
        {role === undefined ? '' : roleName(role)}
      </span>
      <Badge model={model} nowMs={nowMs} />
    </Bar>
  );
}
