// SPDX-License-Identifier: Apache-2.0
// The keys of the page without a server.

import { listenToKeys } from '../ui/keyboard';
import type { Picture } from '../ui/picture';

const NOTHING = (): void => undefined;

export function listenToLocalKeys(
  picture: Picture,
  toggleInspect: () => void,
  toggleCarve: () => void,
): void {
  const rig = () => picture.viewer?.rig;
  listenToKeys({
    preset: (preset) => rig()?.preset(preset, performance.now()),
    fit: () => rig()?.fit(performance.now()),
    orbit: (around, up) => rig()?.orbit(around, up),
    pan: (right, up) => rig()?.pan(right, up),
    zoom: (factor) => rig()?.zoom(factor),
    followNext: NOTHING,
    followNone: NOTHING,
    toggleArrows: NOTHING,
    toggleGrid: () => picture.viewer?.toggleGrid(),
    toggleSound: NOTHING,
    toggleTimeline: NOTHING,
    toggleInspect,
    toggleParallel: () => {
      const { viewer } = picture;
      if (viewer) viewer.parallel = !viewer.rig.parallel;
    },
    toggleCarve,
    undo: NOTHING, // while carving, src/carve/keys.ts listens
    redo: NOTHING,
    help: NOTHING,
  });
}
