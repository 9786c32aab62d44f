// SPDX-License-Identifier: Apache-2.0
// window.kerf of the page without a server, for tests: state(), surface() and marks, as in
// ../shell/hook.ts.

import { marks } from '../model/marks';
import type { LocalPage } from './local_page';

export function installLocalHook(page: LocalPage): void {
  const state = () => {
    const { viewer, ...facts } = page.facts;
    return {
      ...facts,
      hasPicture: viewer !== null,
      pictures: viewer?.pictures ?? null,
      copyTiles: viewer?.local.size ?? 0,
      blockBox: viewer?.blockBox ?? null,
    };
  };
  const surface = () => page.facts.viewer?.surface() ?? [];
  Object.defineProperty(window, 'kerf', {
    value: Object.freeze({ state, surface, marks }),
    writable: false,
  });
}
