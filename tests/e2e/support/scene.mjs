// SPDX-License-Identifier: Apache-2.0
// Scenes of the tests: a box of coarse accuracy, so that software WebGL keeps up.

/** A tool of 30 mm. */
export const cutter = (id, shape, diameterMm) => ({
  id,
  shape,
  diameter_mm: diameterMm,
  length_mm: 30,
});

/** A box from `min` to `max`, in mm. `accuracy` and `others` replace or add fields. */
export function boxScene(name, min, max, tools, { accuracy, ...others } = {}) {
  return {
    name,
    stock: { shape: 'box', min_mm: min, max_mm: max },
    accuracy: {
      rays: 'dexel',
      pitch_mm: 0.5,
      tolerance_mm: 0.01,
      motion: 'tight',
      ...accuracy,
    },
    tools,
    ...others,
  };
}
