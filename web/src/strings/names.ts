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
  'A limewood board for carving a relief by hand.': t(
    'A limewood board for carving a relief by hand.',
  ),
  Cylinder: t('Cylinder'),
  'An upright cylinder for carving a bust by hand, from all sides.': t(
    'An upright cylinder for carving a bust by hand, from all sides.',
  ),
  'Milling job': t('Milling job'),
  'An aluminum plate for three-axis NC programs.': t(
    'An aluminum plate for three-axis NC programs.',
  ),
  '5-axis study': t('5-axis study'),
  'A cylinder on a tilting rotary table (axes A and C).': t(
    'A cylinder on a tilting rotary table (axes A and C).',
  ),
  Ammonite: t('Ammonite'),
  'The block of the ammonite demo, not carved yet.': t(
    'The block of the ammonite demo, not carved yet.',
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
