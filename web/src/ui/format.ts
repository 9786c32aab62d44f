// SPDX-License-Identifier: Apache-2.0
// Formats numbers and sentences for the user.

import { language, t } from '../strings';
import type { StateMessage } from '../wire/types';

const WHOLE = new Intl.NumberFormat(language, { maximumFractionDigits: 0 });

/** 1234567 → "1,234,567" */
export function count(value: number): string {
  return WHOLE.format(value);
}

/** Formats a value with about three significant digits: 0.0123, 1.23, 12.3, 123. */
export function figure(value: number): string {
  if (!Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  if (size < 0.0005) return '0';
  const digits = Math.max(0, Math.min(4, 2 - Math.floor(Math.log10(size))));
  return new Intl.NumberFormat(language, { maximumFractionDigits: digits }).format(value);
}

/**
 * Formats a computed force or torque, followed by the value that the device outputs if they differ:
 * "18.1 N · felt 3.02 (× 0.167)", or "18.1 N · not felt" while the motors are off. `share`: felt
 * over computed; null: not stated.
 */
export function feltBeside(computed: number, share: number | null, unit: string): string {
  const text = `${figure(computed)} ${unit}`;
  if (share === null || share >= 0.99 || figure(computed) === '0') return text;
  if (figure(share) === '0') return t('{0} · not felt', text);
  return t('{0} · felt {1} (× {2})', text, figure(computed * share), figure(share));
}

/** Formats a volume: in mm³, from 1000 mm³ in cm³. */
export function volume(mm3: number): [value: string, unit: string] {
  return mm3 >= 1000 ? [figure(mm3 / 1000), 'cm³'] : [figure(mm3), 'mm³'];
}

const TENTHS = new Intl.NumberFormat(language, {
  minimumFractionDigits: 1,
  maximumFractionDigits: 1,
});

export function milliseconds(value: number): string {
  if (Number.isNaN(value)) return '–';
  if (value >= 10000) return `${figure(value / 1000)} s`;
  return value >= 10 ? `${Math.round(value)} ms` : `${TENTHS.format(value)} ms`;
}

const BEGINS_WITH_FILE = /^[^:]*\.\w+:\d+:|^\S+\.\w+ /;

/**
 * Turns a reason into a sentence: "no hello within 5 s" → "No hello within 5 s." The name of a file
 * stays as it is: "part.ngc:6: 'Q' is not known" → "part.ngc:6: 'Q' is not known."
 */
export function sentence(reason: string): string {
  const first = reason.charAt(0);
  const text = (BEGINS_WITH_FILE.test(reason) ? first : first.toUpperCase()) + reason.slice(1);
  return /[.!?…]$/.test(text) ? text : `${text}.`;
}

const CLOCK = new Intl.DateTimeFormat(language, { timeStyle: 'medium', hourCycle: 'h23' });
const DAY = new Intl.DateTimeFormat(language, { dateStyle: 'medium' });

/** Formats a time in ms since 1970, with its day if that is not today's. */
export function moment(ms: number, nowMs: number): string {
  const [day, clock] = [DAY.format(ms), CLOCK.format(ms)];
  return day === DAY.format(nowMs) ? clock : `${day}, ${clock}`;
}

/** Formats how long ago something was: 3 s, 5 min, 2 h. */
export function duration(milliseconds: number): string {
  const seconds = Math.max(0, Math.floor(milliseconds / 1000));
  if (seconds < 60) return `${seconds} s`;
  return seconds < 3600 ? `${Math.floor(seconds / 60)} min` : `${Math.floor(seconds / 3600)} h`;
}

/** Why nothing can be carved now, as a sentence; empty: it can. */
export function pauseText(state: Pick<StateMessage, 'paused'> | null): string {
  if (state?.paused === undefined) return '';
  return state.paused === 'lease'
    ? t("Carving is paused: the servers can't reach each other.")
    : t("Carving is paused: the server's disk is full or can't be written to.");
}
