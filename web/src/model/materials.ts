// SPDX-License-Identifier: Apache-2.0
// Appearances of the block. `skin` is the color of the original outside, `core` that of cut
// surfaces, so that cuts stand out. `ring` is the color and `grain` the strength (0 to 1) of the
// growth rings of wood, a solid texture through the whole block.

import { t } from '../strings';
import type { ParticipantKind } from '../wire/types';

export interface StockMaterialPreset {
  name: string;
  skin: string;
  core: string;
  ring: string;
  grain: number;
  roughness: number;
  metalness: number;
}

export const STOCK_MATERIALS: readonly StockMaterialPreset[] = [
  {
    name: t('Limewood'),
    skin: '#a06c43',
    core: '#d9bd94',
    ring: '#bd9566',
    grain: 1,
    roughness: 0.62,
    metalness: 0,
  },
  {
    name: t('Walnut'),
    skin: '#5a3d2b',
    core: '#a9805c',
    ring: '#7d573b',
    grain: 1,
    roughness: 0.58,
    metalness: 0,
  },
  {
    name: t('Tooling board'),
    skin: '#5f8fa8',
    core: '#d3dde0',
    ring: '#d3dde0',
    grain: 0,
    roughness: 0.72,
    metalness: 0,
  },
  {
    name: t('Aluminum'),
    skin: '#8b949e',
    core: '#d3d9df',
    ring: '#d3d9df',
    grain: 0,
    roughness: 0.36,
    metalness: 0.6,
  },
  {
    name: t('Clay'),
    skin: '#b5694c',
    core: '#cf8a6b',
    ring: '#cf8a6b',
    grain: 0,
    roughness: 0.9,
    metalness: 0,
  },
];

/**
 * Returns the material of a session in which these carve and no one has chosen another: wood for
 * hands, a plain board for programs, because grain hides the marks that a program leaves.
 */
export function sessionMaterial(kinds: readonly ParticipantKind[]): StockMaterialPreset {
  const isProgram = kinds.length > 0 && kinds.every((kind) => kind === 'program');
  const name = isProgram ? t('Tooling board') : t('Limewood');
  return STOCK_MATERIALS.find((preset) => preset.name === name)!;
}
