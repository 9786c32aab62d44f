// SPDX-License-Identifier: Apache-2.0
// The first request to the worker for the user's files.

import { t } from '../strings';
import { count } from '../ui/format';
import type { ParticipantInfo } from '../wire/types';
import { asRead } from './given_files';
import type { ToWorker } from './messages';
import type { About, GivenFiles } from './program_block';

export interface ReadGiven {
  first: ToWorker & { type: 'open' | 'journal' };
  participants: ParticipantInfo[];
  /** Compares a state with the one that the journal stores; empty if it stores none. */
  compare: (record: number, hash: string | null, about: About) => string;
}

/** Rejects with one line that names the file. */
export async function readGiven(files: GivenFiles): Promise<ReadGiven> {
  const { journal: file } = files;
  if (!file)
    return {
      first: { type: 'open', files: asRead(files) },
      participants: [],
      compare: () => '',
    };
  const { readKerfFile } = await import('./kerf_file');
  const read = await readKerfFile(file.bytes).catch((problem: unknown) => {
    throw new Error(`${file.name}: ${(problem as Error).message}`);
  });
  const { journal, participants, stored, kernelVersion } = read;
  const compare: ReadGiven['compare'] = (record, hash, about) => {
    if (hash === null || record !== stored?.record) return '';
    if (about.kernel_version !== kernelVersion)
      return t('Not verified: the file is from another version of Kerf ({0}).', kernelVersion);
    return hash === stored.hash
      ? t('Verified up to step {0}', count(record))
      : t('Differs at step {0}: {1} here, {2} in the file', count(record), hash, stored.hash);
  };
  return {
    first: { type: 'journal', journal, to: Infinity, isSilent: false },
    participants,
    compare,
  };
}
