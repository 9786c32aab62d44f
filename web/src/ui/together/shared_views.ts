// SPDX-License-Identifier: Apache-2.0
// “Follow me”: shows this viewer's camera to others, and follows the one of another.

import { t } from '../../strings';
import type { CameraMarks } from '../../view/camera_marks';
import type { Viewer } from '../../view/viewer';
import type { CameraPose, ShownCamera, Vec3, Welcome } from '../../wire/types';
import { Vector3 } from 'three';
import { h } from '../dom';
import type { TogetherParts } from './host';
import type { TogetherHost } from './host';

function rounded(place: Vector3): Vec3 {
  return place.toArray().map((value) => Math.round(value * 1000) / 1000) as Vec3;
}

export class SharedViews {
  private isShared_ = false;
  private followed_: number | null = null;
  private sent_ = '';
  private sentTo_: Welcome | null = null;
  private shown_ = '';

  constructor(
    private readonly host: TogetherHost,
    private readonly viewer: Viewer,
    private readonly marks: CameraMarks,
    private readonly parts: TogetherParts,
  ) {}

  /** Shows this viewer's camera, or no longer. */
  share(): void {
    this.isShared_ = !this.isShared_;
    this.parts.share.setAttribute('aria-pressed', String(this.isShared_));
    if (this.isShared_) this.host.say(t('Others can now follow your view.'));
    else this.host.showCamera(null);
    this.sent_ = '';
  }

  update(): void {
    const { welcome, together, status } = this.host.model;
    if (this.sentTo_ !== welcome) this.sent_ = ''; // another connection does not know
    this.sentTo_ = welcome;
    if (this.isShared_ && status === 'connected') this.send_();
    const others = together.cameras.filter((one) => one.participant !== welcome?.participant);
    this.keepFollowing_(others);
    this.list_(others);
    this.marks.show(others.filter(({ participant }) => participant !== this.followed_));
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

  private keepFollowing_(others: readonly ShownCamera[]): void {
    if (this.followed_ === null) return;
    const { rig } = this.viewer;
    const camera = others.find(({ participant }) => participant === this.followed_);
    if (!camera || !rig.tracks) {
      this.host.say(
        camera ? t('You are back to your own view.') : t('The view is no longer shared.'),
      );
      this.follow_(null);
      return;
    }
    rig.track({ eye: new Vector3(...camera.eye_mm), target: new Vector3(...camera.target_mm) });
    if (rig.parallel !== camera.parallel) this.viewer.parallel = camera.parallel;
  }

  private follow_(camera: ShownCamera | null): void {
    this.followed_ = camera?.participant ?? null;
    this.host.picture.follow(null); // of a tool
    this.viewer.rig.track(
      camera && { eye: new Vector3(...camera.eye_mm), target: new Vector3(...camera.target_mm) },
    );
    if (camera) this.host.say(t('You see what {0} sees. Move the view to stop.', camera.name));
  }

  private list_(others: readonly ShownCamera[]): void {
    const key = JSON.stringify([
      this.followed_,
      ...others.map((one) => [one.participant, one.name]),
    ]);
    if (key === this.shown_) return;
    this.shown_ = key;
    this.parts.cameras.replaceChildren(
      ...others.map((camera) => {
        const isFollowed = camera.participant === this.followed_;
        const button = h(
          'button',
          { type: 'button', class: 'chip view-chip', style: `--who:${camera.color}` },
          isFollowed ? t('Following {0}', camera.name) : t('Follow {0}', camera.name),
        );
        button.setAttribute('aria-pressed', String(isFollowed));
        button.addEventListener('click', () => {
          const { cameras } = this.host.model.together;
          const now = cameras.find(({ participant }) => participant === camera.participant);
          this.follow_(isFollowed ? null : (now ?? camera));
        });
        return h('li', {}, button);
      }),
    );
  }
}
