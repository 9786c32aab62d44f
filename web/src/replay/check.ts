// SPDX-License-Identifier: Apache-2.0
// Checks what the server says of the block: replays its journal in this browser, with the same
// kernel, and compares the state hashes.

import { journalOrigin, journalRecords, replayState } from '../link/replay';
import type { ReplayState } from '../link/replay';
import { CarvingWorker } from '../local/carving_worker';
import type { FromWorker } from '../local/messages';

export type Verdict =
  | { is: 'running'; share: number }
  | { is: 'verified'; record: number; hash: string }
  | { is: 'different'; record: number; hash: string; serverHash: string }
  | { is: 'failed'; reason: string };

/** Replays the journal of a session up to its present record; `tell` hears how far it is. */
export async function checkSession(
  session: string,
  tell: (verdict: Verdict) => void,
): Promise<void> {
  tell({ is: 'running', share: 0 });
  try {
    const state = await replayState(session);
    const origin = await journalOrigin(session, state.journal);
    const spans = await journalRecords(session, state.journal, 0, state.record);
    await replayed(state, origin, spans, tell);
  } catch (problem) {
    tell({ is: 'failed', reason: (problem as Error).message });
  }
}

/** Compares the state after the record of the server's. */
function replayed(
  state: ReplayState,
  origin: Uint8Array<ArrayBuffer>,
  spans: Uint8Array<ArrayBuffer>[],
  tell: (verdict: Verdict) => void,
): Promise<void> {
  return new Promise((resolve) => {
    const end = (verdict: Verdict): void => {
      worker.end();
      tell(verdict);
      resolve();
    };
    const heard = (message: FromWorker): void => {
      if (message.type === 'rejected' || message.type === 'failed')
        end({ is: 'failed', reason: message.reason });
      if (message.type !== 'carved') return;
      const { hash, progress } = message;
      if (hash === null) tell({ is: 'running', share: progress.carved / state.record });
      else end(compared(state, progress.carved, hash));
    };
    const worker = new CarvingWorker(heard);
    worker.open({
      type: 'journal',
      journal: { origin, spans },
      to: state.record,
      isSilent: true,
    });
  });
}

/** What a replay says that has reached a record with a hash. */
export function compared(state: ReplayState, record: number, hash: string): Verdict {
  if (record === state.record && hash === state.state_hash) return { is: 'verified', record, hash };
  return { is: 'different', record, hash, serverHash: state.state_hash };
}
