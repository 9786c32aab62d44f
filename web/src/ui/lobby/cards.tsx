// SPDX-License-Identifier: Apache-2.0
// The sessions as cards: picture, name, people, age, size. They follow what happens on the server.

import { useSignal } from '@preact/signals';
import { useEffect, useLayoutEffect, useMemo, useRef } from 'preact/hooks';
import { t } from '../../strings';
import type { SessionSummary } from '../../link/api';
import { sessionDetails } from '../../link/lobby_requests';
import type { Person, SessionDetails } from '../../link/lobby_requests';
import { pictureUrl, PictureVersions } from '../../link/picture_url';
import { ageText, stockText } from '../../model/new_block';
import { figure } from '../format';
import { CardMenu } from './card_menu';
import type { CardAction } from './card_menu';
import { sessionUrl } from './session_url';

const PEOPLE_MAX = 4;

/** Who carves first, then who watches. */
function ordered(people: readonly Person[]): Person[] {
  const watches = ({ kind }: Person): boolean => kind === 'viewer';
  return [...people.filter((one) => !watches(one)), ...people.filter(watches)];
}

function People({ people }: { people: readonly Person[] }) {
  const shown = ordered(people).slice(0, PEOPLE_MAX);
  const left = people.length - shown.length;
  return (
    <ul class="chips" aria-label={t('Participants')} hidden={people.length === 0}>
      {shown.map(({ name, color }, n) => (
        <li key={n} class="chip">
          <span class="chip-dot" aria-hidden="true" style={`background:${color}`} />
          {name}
        </li>
      ))}
      {left > 0 && <li class="chip">{`+ ${left}`}</li>}
    </ul>
  );
}

/** Returns people and stock of a session, requested again when they may have changed. */
function useDetails({ id, participants }: SessionSummary): SessionDetails | null {
  const details = useSignal<SessionDetails | null>(null);
  const askedFor = useRef(-1); // number of participants
  useEffect(() => {
    if (participants === askedFor.current) return;
    askedFor.current = participants;
    sessionDetails(id).then(
      (found) => (details.value = found),
      () => (askedFor.current = -1), // with the next list
    );
  });
  return details.value;
}

interface CardProps {
  session: SessionSummary;
  /** What the viewer may do with a session. */
  actions: (session: SessionSummary) => readonly CardAction[];
}

function Card({ session, actions }: CardProps) {
  const { id, name, motions, removedVolumeMm3, activeMs } = session;
  const versions = useMemo(() => new PictureVersions(), []);
  const picture = useRef('');
  const version = versions.next(motions, removedVolumeMm3);
  if (version !== null) picture.current = pictureUrl(id, version, 480);
  const details = useDetails(session);
  return (
    <li class="card-place">
      <a class="card" href={sessionUrl(id)}>
        <img class="card-picture" alt="" width="480" height="360" src={picture.current} />
        <span class="card-text">
          <strong>{name}</strong>
          <span class="quiet">
            {activeMs === null ? '' : t('Active {0}', ageText(activeMs, Date.now()))}
          </span>
          <span class="quiet">
            {details && t('{0} · detail {1} mm', stockText(details.stock), figure(details.pitchMm))}
          </span>
        </span>
      </a>
      <People people={details?.people ?? []} />
      <CardMenu name={name} actions={actions(session)} />
    </li>
  );
}

interface CardsProps extends Pick<CardProps, 'actions'> {
  /** In their order. */
  sessions: readonly SessionSummary[];
}

export function Cards({ sessions, actions }: CardsProps) {
  const list = useRef<HTMLUListElement>(null);
  const { activeElement: focused } = document;
  useLayoutEffect(() => {
    // A card that moves keeps the focus.
    if (!(focused instanceof HTMLElement) || focused === document.activeElement) return;
    if (list.current?.contains(focused)) focused.focus({ preventScroll: true });
  });
  return (
    <ul ref={list} class="cards">
      {sessions.map((session) => (
        <Card key={session.id} session={session} actions={actions} />
      ))}
    </ul>
  );
}
