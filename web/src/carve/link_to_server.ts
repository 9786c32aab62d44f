// SPDX-License-Identifier: Apache-2.0
import { socketUrl } from '../link/address';
import { notePerson, personIn } from '../link/kept_person';
import type { Socket } from '../link/socket';
import { listStrokes } from '../link/strokes';
import { CarveLink } from './carve_link';
import type { CarveLinkEvents, CarveLinkOptions } from './carve_link';

/** The link to a session of the server that the page comes from. */
export function linkToServer(
  session: string,
  copy: CarveLinkOptions['copy'],
  who: CarveLinkOptions['who'],
  events: CarveLinkEvents,
): CarveLink {
  return new CarveLink(
    {
      url: socketUrl(session, 'agent'),
      open: (url, protocol) => new WebSocket(url, protocol) as unknown as Socket,
      who,
      nowMs: () => performance.now(),
      copy,
      list: (since) => listStrokes(session, since),
      token: personIn(session).token,
      keep: (token) => notePerson(session, { token }),
    },
    events,
  );
}
