// SPDX-License-Identifier: Apache-2.0
// Publishes window.kerf for tests: state(), a read-only snapshot of the page's state, surface(),
// the triangles it displays, copyHash(), that of its copy of the block while one carves, vr(), the
// state of a headset, and marks, the times of its start.

import { marks } from '../model/marks';
import type { SessionPage } from './session_page';

function cameraOf({ picture }: SessionPage) {
  const { camera, controls } = picture.viewer?.rig ?? {};
  if (!camera || !controls) return null;
  return { eye: camera.position.toArray(), target: controls.target.toArray() };
}

export function installHook(page: SessionPage): void {
  const { model } = page;
  const state = () => ({
    status: model.status,
    session: model.welcome?.session ?? null,
    epoch: model.welcome?.epoch ?? null,
    hash: model.state?.state_hash ?? null,
    settled: model.state?.settled ?? false,
    motions: model.state?.motions ?? 0,
    past: model.state?.at ?? null,
    removedVolumeMm3: model.state?.removed_volume_mm3 ?? 0,
    snapshotComplete: model.tiles.complete,
    exactTiles: page.picture.isExact,
    tiles: model.tiles
      .list()
      .map(({ x, y, version, level, triangles }) => ({ x, y, version, level, triangles })),
    triangles: model.tiles.triangles,
    meshFrames: model.meshFrames,
    problems: model.problems,
    problem: model.problem,
    rttMs: model.clock.rttMs,
    behind: model.lag.isBehind(performance.now()),
    stalenessMs: model.stalenessMs(performance.now()),
    participants: model.participants.all().map(({ info, status, forces }) => ({
      ...info,
      status,
      peakForceN: forces.peak.forceN,
      forceSamples: forces.count,
    })),
    hasPicture: page.picture.viewer !== null,
    pictures: page.picture.viewer?.pictures ?? null,
    copyTiles: page.picture.viewer?.local.size ?? 0,
    blockBox: page.picture.viewer?.blockBox ?? null,
    drawCalls: page.picture.viewer?.drawCalls ?? 0,
    meshBytes: model.meshBytes,
    camera: cameraOf(page),
    followed: page.picture.followed,
    sound: page.sound.state,
  });
  const copyHash = () => page.carve.copyHash();
  const vr = () => page.carve.vrState;
  const surface = () => page.picture.viewer?.surface() ?? [];
  Object.defineProperty(window, 'kerf', {
    value: Object.freeze({ state, surface, marks, copyHash, vr }),
    writable: false,
  });
}
