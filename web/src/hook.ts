// SPDX-License-Identifier: Apache-2.0
// Publishes window.kerf.state(), a read-only snapshot of the page's state for tests.

import type { SessionPage } from './ui/session_page';

export function installHook(page: SessionPage): void {
  const { model } = page;
  const state = () => ({
    status: model.status,
    session: model.welcome?.session ?? null,
    epoch: model.welcome?.epoch ?? null,
    hash: model.state?.state_hash ?? null,
    settled: model.state?.settled ?? false,
    motions: model.state?.motions ?? 0,
    removedVolumeMm3: model.state?.removed_volume_mm3 ?? 0,
    snapshotComplete: model.tiles.complete,
    tiles: model.tiles
      .list()
      .map(({ x, y, version, level, triangles }) => ({ x, y, version, level, triangles })),
    triangles: model.tiles.triangles,
    meshFrames: model.meshFrames,
    problems: model.problems,
    problem: model.problem,
    rttMs: model.clock.rttMs,
    stalenessMs: model.stalenessMs(performance.now()),
    participants: model.participants.all().map(({ info, status, forces }) => ({
      ...info,
      status,
      peakForceN: forces.peak.forceN,
      forceSamples: forces.count,
    })),
    followed: page.followed,
    sound: page.sound.state,
  });
  Object.defineProperty(window, 'kerf', { value: Object.freeze({ state }), writable: false });
}
