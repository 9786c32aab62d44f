// SPDX-License-Identifier: Apache-2.0
// The check of the session's history: a button that has the journal checked, and what came out.

import { t } from '../strings';
import { h, setText } from '../ui/dom';
import { count } from '../ui/format';
import type { Verdict } from './check';
import type { Difference } from './first_difference';

function firstText({ after, by }: Difference): string {
  return by === after + 1
    ? t('The first difference is at step {0}.', count(by))
    : t('The first difference is between steps {0} and {1}.', count(after + 1), count(by));
}

/** What happened, for who wants to know more than the badge says. */
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

/** @param check replays the journal of the session (check.ts), a chunk that is loaded then */
export function checkBadge(
  check: (tell: (verdict: Verdict) => void) => Promise<void>,
): HTMLElement {
  const result = h('span', { class: 'check-result', role: 'status' });
  const explanation = h('span', { class: 'check-result', role: 'status' });
  const button = h(
    'button',
    {
      type: 'button',
      class: 'quiet-action',
      title: t('Replay the history in this browser and compare block and view with it'),
    },
    t('Verify'),
  );
  const show = (verdict: Verdict): void => {
    result.dataset['verdict'] = verdict.is;
    setText(result, textOf(verdict));
    setText(explanation, explanationOf(verdict));
  };
  button.addEventListener('click', () => {
    button.disabled = true;
    void check(show)
      .catch((problem: unknown) => show({ is: 'failed', reason: (problem as Error).message }))
      .finally(() => (button.disabled = false));
  });
  return h('span', { class: 'check' }, button, result, explanation);
}
