// SPDX-License-Identifier: Apache-2.0

import { t } from '../../strings';
import type { Alarm } from './requests';
import { alarmText } from './texts';

interface AlarmListProps {
  alarms: readonly Alarm[];
  press: (alarm: Alarm) => void;
}

/**
 * The alarms of a program as buttons. The server extends the last alarms while a program moves, so
 * the text of a row changes in place.
 */
export function AlarmList({ alarms, press }: AlarmListProps) {
  return (
    <ul class="program-alarms" aria-label={t('Alarms')}>
      {alarms.map((alarm, at) => (
        <li key={at}>
          <button type="button" onClick={() => press(alarm)}>
            {alarmText(alarm)}
          </button>
        </li>
      ))}
    </ul>
  );
}
