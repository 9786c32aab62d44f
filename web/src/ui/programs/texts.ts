// SPDX-License-Identifier: Apache-2.0
// Sentences about programs for the user.

import { wallSeconds } from '../../model/programs';
import type { ProgramInfo } from '../../wire/types';
import { figure } from '../format';
import type { Alarm } from './requests';

/** 4 → "4 s", 75 → "1:15", 3700 → "1:01:40" */
export function duration(seconds: number): string {
  if (!Number.isFinite(seconds)) return '–';
  if (seconds < 60) return `${figure(seconds)} s`;
  const whole = Math.round(seconds);
  const two = (value: number): string => String(value).padStart(2, '0');
  const [h, m, s] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  return h > 0 ? `${h}:${two(m)}:${two(s)}` : `${m}:${two(s)}`;
}

/** What a program is doing, in a few words. */
export function stateText(program: ProgramInfo): string {
  switch (program.state) {
    case 'queued':
      return `waits for program ${program.after ?? 0}`;
    case 'running': {
      if (program.waiting) return "waits for the server's disk";
      const left = wallSeconds(program);
      return Number.isNaN(left) ? 'running at full speed' : `running, ${duration(left)} left`;
    }
    case 'paused':
      return `paused at line ${program.line}`;
    case 'finished':
      return 'finished';
    case 'cancelled':
      return program.error === undefined ? 'cancelled' : `cancelled: ${program.error}`;
    case 'failed':
      return `failed: ${program.error ?? ''}`;
    case 'unknown':
      return '';
  }
}

const ALARMS: Record<string, string> = {
  rapid: 'Rapid through stock',
  shank: 'Shank or holder in the stock',
  obstacle: 'Collision with an obstacle',
  force: 'Force over the limit',
};
const UNITS: Record<string, string> = { mm3: 'mm³' };

export function alarmText(alarm: Alarm): string {
  const lines =
    alarm.fromLine === alarm.toLine
      ? `line ${alarm.fromLine}`
      : `lines ${alarm.fromLine}–${alarm.toLine}`;
  const what = ALARMS[alarm.kind] ?? alarm.kind;
  const amount = `${figure(alarm.amount)} ${UNITS[alarm.unit] ?? alarm.unit}`;
  const [x, y, z] = alarm.tip.map((value) => value.toFixed(1));
  return `${what}, ${amount}: ${lines}, at X ${x} Y ${y} Z ${z}`;
}
