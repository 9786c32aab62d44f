// SPDX-License-Identifier: Apache-2.0
// Waits for the end of the program with which a session was created.

import { effect, untracked } from '@preact/signals';
import type { Programs } from '../../model/programs';
import type { ProgramInfo } from '../../wire/types';
import { ProgramRequests } from './requests';

/**
 * Calls `then` once, when the first program of the session has finished; never if it was cancelled
 * or has failed.
 */
export function whenFinished(
  programs: Programs,
  session: string,
  then: (program: ProgramInfo) => void,
): void {
  let isDone = false;
  effect(() => {
    const first = programs
      .all()
      .reduce<ProgramInfo | null>(
        (oldest, program) => (oldest && oldest.id < program.id ? oldest : program),
        null,
      );
    if (isDone || first?.state !== 'finished') return;
    isDone = true;
    untracked(() => then(first));
  });
  // A program that ended before the page was there is not pushed.
  new ProgramRequests(session).list().then(
    (answer) => programs.add(answer.map(({ program }) => program)),
    () => undefined, // the panel of programs tells the problem when it is opened
  );
}
