// SPDX-License-Identifier: Apache-2.0
// “Follow me”: shows this viewer's camera to other viewers, and follows the camera of one of them.

import { effect } from '@preact/signals';
import { Vector3 } from 'three';
import { t } from '../../strings';
import type { CameraMarks } from '../../view/camera_marks';
import type { Viewer } from '../../view/viewer';
import type { CameraPose, ShownCamera, Vec3, Welcome } from '../../wire/types';
import type { TogetherHost } from './host';
import type { TogetherState } from './state';

function rounded(place: Vector3): Vec3 {
  return place.toArray().map((value) => Math.round(value * 1000) / 1000) as Vec3;
}

export class SharedViews {
  private sent_ = '';
  private sentTo_: Welcome | null = null;

  constructor(
    private readonly host: TogetherHost,
    private readonly viewer: Viewer,
    private readonly marks: CameraMarks,
    private readonly state: TogetherState,
  ) {
    effect(() => this.receive_());
  }

  /** The cameras that other viewers show. */
  get offered(): ShownCamera[] {
    const { welcome, together } = this.host.model;
    return together.cameras.filter((one) => one.participant !== welcome?.participant);
  }

  /** The participant whose camera is followed; null if none is. */
  get followed(): number | null {
    return this.state.followed.value;
  }

  /** Begins or ends to show this viewer's camera. */
  share(): void {
    const { isShared } = this.state;
    isShared.value = !isShared.value;
    if (isShared.value) this.host.say(t('Others can now follow your view.'));
    else this.host.showCamera(null);
    this.sent_ = '';
  }

  /** Follows a camera; null: the view is this viewer's own again. */
  follow(camera: ShownCamera | null): void {
    this.host.picture.follow(null); // no tool either
    this.viewer.rig.track(
      camera && { eye: new Vector3(...camera.eye_mm), target: new Vector3(...camera.target_mm) },
    );
    this.state.followed.value = camera?.participant ?? null;
    if (camera) this.host.say(t('You see what {0} sees. Move the view to stop.', camera.name));
  }

  /** Sends the camera if it has moved, and notices that the user has moved it. */
  update(): void {
    const { welcome, status } = this.host.model;
    if (this.sentTo_ !== welcome) this.sent_ = ''; // a new connection has not seen our camera
    this.sentTo_ = welcome;
    if (this.state.isShared.value && status === 'connected') this.send_();
    if (this.followed !== null && !this.viewer.rig.tracks) this.end_();
  }

  private send_(): void {
    const { camera, controls, parallel } = this.viewer.rig;
    const pose: CameraPose = {
      eye_mm: rounded(camera.position),
      target_mm: rounded(controls.target),
      parallel,
    };
    const text = JSON.stringify(pose);
    if (text === this.sent_) return;
    this.sent_ = text;
    this.host.showCamera(pose);
  }

  /** Moves the view with the camera that is followed, and marks the cameras of the others. */
  private receive_(): void {
    const { offered, followed } = this;
    this.marks.show(offered.filter(({ participant }) => participant !== followed));
    if (followed === null) return;
    const { rig } = this.viewer;
    const camera = offered.find(({ participant }) => participant === followed);
    if (!camera || !rig.tracks) {
      this.end_();
      return;
    }
    rig.track({ eye: new Vector3(...camera.eye_mm), target: new Vector3(...camera.target_mm) });
    if (rig.parallel !== camera.parallel) this.viewer.parallel = camera.parallel;
  }

  private end_(): void {
    const isOffered = this.offered.some(({ participant }) => participant === this.followed);
    this.host.say(
      isOffered ? t('You are back to your own view.') : t('The view is no longer shared.'),
    );
    this.follow(null);
  }
}
