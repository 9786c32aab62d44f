// SPDX-License-Identifier: Apache-2.0

import { t } from '../../strings';
import { PATH_COLORS } from '../../view/path_view';
import type { PathControl } from './path_control';

const LEGEND = [
  ['past', t('done')],
  ['future', t('to do')],
  ['rapid', t('rapid')],
] as const;

/** Whether the path of the program is shown, and its colors. */
export function PathRow({ path }: { path: PathControl }) {
  return (
    <p class="program-path">
      <label>
        <input
          type="checkbox"
          checked={path.isWanted.value}
          onChange={({ currentTarget }) => path.want(currentTarget.checked)}
        />
        {t(' Show path')}
      </label>
      {LEGEND.map(([name, text]) => (
        <span key={name} class={`path-key ${name}`} style={`--line:${PATH_COLORS[name]}`}>
          {text}
        </span>
      ))}
      <span class="quiet">{path.note.value}</span>
    </p>
  );
}
