// SPDX-License-Identifier: Apache-2.0
// The buttons of one program: pause and resume, step, speed, cancel.

import { useSignal } from '@preact/signals';
import { t } from '../../strings';
import { isOpen } from '../../model/programs';
import type { ProgramInfo } from '../../wire/types';

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20].map(String);
const FAST = 'fast';

export interface ControlActions {
  /** A query of PATCH, as in server/http/README.md. */
  change: (query: string) => void;
  cancel: () => void;
  /** Shows the cuts of an ended program again; missing without a timeline. */
  replay: ((program: ProgramInfo) => void) | undefined;
}

interface SpeedProps {
  /** The speed of the program, which another client may have chosen freely. */
  speed: string;
  disabled: boolean;
  change: (speed: string) => void;
}

/** The menu of speeds. While it has the focus it keeps the speed that is being chosen. */
function SpeedMenu({ speed, disabled, change }: SpeedProps) {
  const held = useSignal<string | null>(null);
  const value = held.value ?? speed;
  const others = [FAST, ...SPEEDS].includes(value) ? [] : [value];
  return (
    <select
      class="program-speed"
      aria-label={t('Speed')}
      value={value}
      disabled={disabled}
      onFocus={() => (held.value = speed)}
      onBlur={() => (held.value = null)}
      onChange={({ currentTarget }) => {
        if (held.value !== null) held.value = currentTarget.value;
        change(currentTarget.value);
      }}
    >
      {SPEEDS.map((one) => (
        <option key={one} value={one}>{`× ${one}`}</option>
      ))}
      <option key={FAST} value={FAST}>
        {t('Full speed')}
      </option>
      {others.map((one) => (
        <option key={one} value={one}>{`× ${one}`}</option>
      ))}
    </select>
  );
}

interface ControlsProps {
  program: ProgramInfo;
  /** Whether this viewer may control the program. */
  may: boolean;
  actions: ControlActions;
}

export function Controls({ program, may, actions }: ControlsProps) {
  const isPaused = program.state === 'paused';
  const canStep = may && (program.state === 'running' || isPaused);
  const canEnd = may && isOpen(program);
  return (
    <div class="program-controls" role="group" aria-label={t('Program controls')}>
      {isOpen(program) || !actions.replay ? (
        <button
          type="button"
          class="button program-play"
          disabled={!canStep}
          onClick={() => actions.change(isPaused ? 'do=resume' : 'do=pause')}
        >
          {isPaused ? t('Resume') : t('Pause')}
        </button>
      ) : (
        <button
          type="button"
          class="button program-play"
          title={t('Show the cuts of this program again, one after another')}
          disabled={program.motions_done === 0}
          onClick={() => actions.replay?.(program)}
        >
          {t('Play the cuts')}
        </button>
      )}
      <button
        type="button"
        class="button quiet-button"
        title={t('Run one line, then pause')}
        disabled={!canStep}
        onClick={() => actions.change('do=step')}
      >
        {t('Step')}
      </button>
      <SpeedMenu
        speed={program.pace === 'fast' ? FAST : String(program.speed ?? 1)}
        disabled={!canEnd}
        change={(speed) => actions.change(speed === FAST ? 'pace=fast' : `speed=${speed}`)}
      />
      <button
        type="button"
        class="button quiet-button"
        disabled={!canEnd}
        onClick={() => actions.cancel()}
      >
        {t('Cancel')}
      </button>
    </div>
  );
}
