// SPDX-License-Identifier: Apache-2.0
// Names for words of the protocol, and the texts of the server's templates.

import { t } from './index';

const ROLES: Partial<Record<string, string>> = {
  watcher: t('watcher'),
  sculptor: t('sculptor'),
  owner: t('owner'),
};

const SHAPES: Partial<Record<string, string>> = {
  flat: t('flat'),
  ball: t('ball'),
  bull_nose: t('bull nose'),
  taper: t('taper'),
  cone_end: t('cone end'),
  profile: t('profile'),
};

const TEMPLATES: Partial<Record<string, string>> = {
  Box: t('Box'),
  'A board of limewood for a relief, carved by hand.': t(
    'A board of limewood for a relief, carved by hand.',
  ),
  Cylinder: t('Cylinder'),
  'An upright cylinder for a bust, carved by hand from all sides.': t(
    'An upright cylinder for a bust, carved by hand from all sides.',
  ),
  'Milling job': t('Milling job'),
  'A plate of aluminium for NC programs on three axes.': t(
    'A plate of aluminium for NC programs on three axes.',
  ),
  '5-axis study': t('5-axis study'),
  'A cylinder on a tilting rotary table (A and C).': t(
    'A cylinder on a tilting rotary table (A and C).',
  ),
  Ammonite: t('Ammonite'),
  'The block of the demo, in which two simulated hands carve.': t(
    'The block of the demo, in which two simulated hands carve.',
  ),
};

/** A title or description of one of the server's templates. */
export function templateText(english: string): string {
  return TEMPLATES[english] ?? english;
}

/** A role, as the server names it. */
export function roleName(role: string): string {
  return ROLES[role] ?? role;
}

/** The shape of a tool, as scenes name it. */
export function shapeName(shape: string): string {
  return SHAPES[shape] ?? shape.replace('_', ' ');
}
