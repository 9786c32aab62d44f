// SPDX-License-Identifier: Apache-2.0
// What the block seems to be made of. `skin` is the untouched outside, `core` what the tool lays open, so a cut shows at once;
// `ring` and `grain` draw year rings through the whole block, as real wood has them.

export interface StockLook {
  name: string;
  skin: string;
  core: string;
  ring: string;
  grain: number;
  roughness: number;
  metalness: number;
}

export const STOCK_LOOKS: readonly StockLook[] = [
  { name: 'Limewood', skin: '#a06c43', core: '#d9bd94', ring: '#bd9566', grain: 1, roughness: 0.62, metalness: 0 },
  { name: 'Walnut', skin: '#5a3d2b', core: '#a9805c', ring: '#7d573b', grain: 1, roughness: 0.58, metalness: 0 },
  { name: 'Tooling board', skin: '#5f8fa8', core: '#d3dde0', ring: '#d3dde0', grain: 0, roughness: 0.72, metalness: 0 },
  { name: 'Aluminium', skin: '#8b949e', core: '#d3d9df', ring: '#d3d9df', grain: 0, roughness: 0.36, metalness: 0.6 },
  { name: 'Clay', skin: '#b5694c', core: '#cf8a6b', ring: '#cf8a6b', grain: 0, roughness: 0.9, metalness: 0 },
];
