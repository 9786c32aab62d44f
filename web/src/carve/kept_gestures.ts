// SPDX-License-Identifier: Apache-2.0
import { notePerson, personIn } from '../link/kept_person';
import type { Count } from './gestures';
import type { Sampler } from './sampler';

/** The page that is loaded again undoes the gestures of this one. */
export function keepGestures(session: string, sampler: Sampler, count: Count): void {
  const { gestures } = personIn(session);
  if (gestures) sampler.restore(gestures);
  const keep = (): void => notePerson(session, { gestures: sampler.keep(count) });
  window.addEventListener('pagehide', keep, { capture: true }); // before the person is kept
}
