// SPDX-License-Identifier: Apache-2.0
// The check of the session's history by the page.

import { useSignal } from '@preact/signals';
import { t } from '../strings';
import { count } from '../ui/format';
import type { Verdict } from './check';
import type { Difference } from './first_difference';

function firstText({ after, by }: Difference): string {
  return by === after + 1
    ? t('The first difference is at step {0}.', count(by))
    : t('The first difference is between steps {0} and {1}.', count(after + 1), count(by));
}

/** The first differing step, if it is known. */
function explanationOf(verdict: Verdict): string {
  return verdict.is === 'different' && verdict.first ? firstText(verdict.first) : '';
}

function textOf(verdict: Verdict): string {
  switch (verdict.is) {
    case 'running':
      return t('Verifying: {0} %', Math.floor(100 * verdict.share));
    case 'waiting':
      if (verdict.isBehind) return t('Not verified: the view is behind the block');
      return t(
        'Step {0} is right. The view will be verified once nobody is carving.',
        count(verdict.record),
      );
    case 'unseen':
      return t('Not verified: the view differs from step {0}', count(verdict.record));
    case 'verified':
      return t('Verified up to step {0}', count(verdict.record));
    case 'different':
      return t(
        'Differs at step {0}: {1} here, {2} on the server',
        count(verdict.record),
        verdict.hash,
        verdict.serverHash,
      );
    case 'failed':
      return t('Not verified: {0}', verdict.reason);
  }
}

/** Replays the journal of the session (check.ts), and reports how far it is. */
export type Check = (tell: (verdict: Verdict) => void) => Promise<void>;

/** A button that has the journal checked, and the verdict. */
export function CheckBadge({ check }: { check: Check }) {
  const verdict = useSignal<Verdict | null>(null);
  const isBusy = useSignal(false);
  const run = async (): Promise<void> => {
    isBusy.value = true;
    try {
      await check((one) => (verdict.value = one));
    } catch (problem) {
      verdict.value = { is: 'failed', reason: (problem as Error).message };
    }
    isBusy.value = false;
  };
  const { value } = verdict;
  return (
    <span class="check">
      <button
        type="button"
        class="quiet-action"
        title={t('Replay the history in this browser and compare block and view with it')}
        disabled={isBusy.value}
        onClick={() => void run()}
      >
        {t('Verify')}
      </button>
      <span class="check-result" role="status" data-verdict={value?.is}>
        {value && textOf(value)}
      </span>
      <span class="check-result" role="status">
        {value && explanationOf(value)}
      </span>
    </span>
  );
}
