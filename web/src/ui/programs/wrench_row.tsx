// SPDX-License-Identifier: Apache-2.0

import { t } from '../../strings';
import { WRENCH_COLORS } from '../../model/arrow_scale';
import { figure } from '../format';
import type { WrenchControl } from './wrench_control';

/** Whether force and torque are shown along the path of the program, and their greatest values. */
export function WrenchRow({ wrench }: { wrench: WrenchControl }) {
  const { value: greatest } = wrench.greatest;
  if (!greatest) return null;
  const keys = [
    [WRENCH_COLORS.force, `${figure(greatest.forceN)} N`],
    [WRENCH_COLORS.torque, `${figure(greatest.torqueNmm)} N·mm`],
  ] as const;
  return (
    <p class="program-path">
      <label>
        <input
          type="checkbox"
          checked={wrench.isWanted.value}
          onChange={({ currentTarget }) => (wrench.isWanted.value = currentTarget.checked)}
        />
        {t(' Show force and torque')}
      </label>
      {keys.map(([color, amount]) => (
        <span key={color} class="path-key" style={`--line:${color}`}>
          {t('up to {0}', amount)}
        </span>
      ))}
    </p>
  );
}
