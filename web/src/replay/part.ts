// SPDX-License-Identifier: Apache-2.0
// Who answers the timeline's seeks: the page itself, by code that is loaded with the first one, or
// the server.

import type { SessionModel } from '../model/session';
import type { Viewer } from '../view/viewer';
import type { Seek, StateMessage } from '../wire/types';
import type { SessionCheck } from './check';
import type { LocalPast, PastHost } from './local_past';
import type { Check } from './badge';

/** Whether kerf_files.wasm was there when the page was built, or was to come later (vite.config.ts). */
declare const KERF_HAS_FILES: boolean;

export interface Past {
  /** Whether the picture is the page's own past. */
  readonly isShown: boolean;
  seek: (seek: Seek) => void;
  keep: (state: StateMessage) => void;
  welcomed: () => void;
  /** Back to the present, if the page shows its own past. */
  leave: () => void;
}

/** The past by the server alone, where the page cannot replay. */
function byServer(seek: (seek: Seek) => void): Past {
  const nothing = (): void => undefined;
  return { isShown: false, seek, keep: nothing, welcomed: nothing, leave: nothing };
}

export function pastOf(host: PastHost): Past {
  if (!KERF_HAS_FILES) return byServer(host.seek);
  let past: LocalPast | null = null;
  let last: Seek | null = null; // until the code is there
  const load = async (): Promise<void> => {
    try {
      const { LocalPast } = await import('./local_past');
      past = new LocalPast(host);
    } catch (problem) {
      console.warn('The replay did not load:', problem);
    }
    if (last) (past ?? host).seek(last);
    last = null;
  };
  return {
    get isShown() {
      return past?.isShown ?? false;
    },
    seek: (seek) => {
      if (past) past.seek(seek);
      else {
        if (last === null) void load();
        last = seek;
      }
    },
    keep: (state) => past?.keep(state),
    welcomed: () => past?.welcomed(),
    leave: () => {
      if (past?.isShown) past.seek({ type: 'seek', at: 'live' });
    },
  };
}

/** The check of the session's history; null where the page cannot replay. */
export function checkOf(
  session: string,
  model: SessionModel,
  viewer: () => Viewer | null,
): Check | null {
  if (!KERF_HAS_FILES) return null;
  let check: SessionCheck | null = null; // keeps its verified records
  return async (tell) => {
    const [{ SessionCheck }, { shownPicture }] = await Promise.all([
      import('./check'),
      import('./shown_picture'),
    ]);
    check ??= new SessionCheck(session, () => shownPicture(model, viewer()));
    await check.run(tell);
  };
}
