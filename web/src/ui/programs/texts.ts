// SPDX-License-Identifier: Apache-2.0
// Sentences about programs for the user.

import { t } from '../../strings';
import { wallSeconds } from '../../model/programs';
import type { ProgramInfo } from '../../wire/types';
import { figure } from '../format';
import type { Alarm, ProgramDetails } from './requests';

/** 4 → "4 s", 75 → "1:15", 3700 → "1:01:40" */
export function duration(seconds: number): string {
  if (!Number.isFinite(seconds)) return '–';
  if (seconds < 60) return `${figure(seconds)} s`;
  const whole = Math.round(seconds);
  const two = (value: number): string => String(value).padStart(2, '0');
  const [h, m, s] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  return h > 0 ? `${h}:${two(m)}:${two(s)}` : `${m}:${two(s)}`;
}

/** The state of a program, in a few words. */
export function stateText(program: ProgramInfo): string {
  switch (program.state) {
    case 'queued':
      return t('waiting for program {0}', program.after ?? 0);
    case 'running': {
      if (program.waiting) return t("waiting for the server's disk");
      const left = wallSeconds(program);
      return Number.isNaN(left)
        ? t('running at full speed')
        : t('running, {0} left', duration(left));
    }
    case 'paused':
      return t('paused at line {0}', program.line);
    case 'finished':
      return t('finished');
    case 'cancelled':
      return program.error === undefined ? t('cancelled') : t('cancelled: {0}', program.error);
    case 'failed':
      return t('failed: {0}', program.error ?? '');
    case 'unknown':
      return '';
  }
}

/** For which gouges a program is watched. */
export function watchText({ target, targetToleranceMm }: ProgramDetails): string {
  return t('Watching for gouges into {0} deeper than {1} mm.', target, figure(targetToleranceMm));
}

const ALARMS: Record<string, string> = {
  rapid: t('Rapid move through material'),
  shank: t('Shank or holder touches the block'),
  obstacle: t('Collision with an obstacle'),
  force: t('Force above the limit'),
  gouge: t('Gouge into the part'),
};

export function alarmText(alarm: Alarm): string {
  const lines =
    alarm.fromLine === alarm.toLine
      ? t('line {0}', alarm.fromLine)
      : t('lines {0}–{1}', alarm.fromLine, alarm.toLine);
  const what = ALARMS[alarm.kind] ?? alarm.kind;
  const amount =
    alarm.limit > 0
      ? t('{0} {1}, limit {2}', figure(alarm.amount), alarm.unit, figure(alarm.limit))
      : `${figure(alarm.amount)} ${alarm.unit}`;
  const [x, y, z] = alarm.place.map((value) => value.toFixed(1)) as [string, string, string];
  return t('{0}, {1}: {2}, at X {3} Y {4} Z {5}', what, amount, lines, x, y, z);
}
