// SPDX-License-Identifier: Apache-2.0

import { t } from '../../strings';
import type { ProgramInfo } from '../../wire/types';
import { count } from '../format';
import { stateText } from './texts';

interface ProgramListProps {
  programs: readonly ProgramInfo[];
  selected: number | null;
  press: (id: number) => void;
}

/** The list of programs as buttons. */
export function ProgramList({ programs, selected, press }: ProgramListProps) {
  return (
    <ul class="program-list" aria-label={t('Programs')}>
      {programs.map((program) => {
        const noun = program.alarm_count === 1 ? t('alarm') : t('alarms');
        const alarms = program.alarm_count > 0 ? ` · ${count(program.alarm_count)} ${noun}` : '';
        return (
          <li key={program.id}>
            <button
              type="button"
              class="program-row-button"
              data-state={program.state}
              aria-pressed={program.id === selected}
              onClick={() => press(program.id)}
            >
              <b>{program.name}</b>
              <small>{`${stateText(program)}${alarms}`}</small>
            </button>
          </li>
        );
      })}
    </ul>
  );
}
