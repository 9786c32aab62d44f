// SPDX-License-Identifier: Apache-2.0
// What viewers do together: pins on the surface, views that others follow, pictures to take along.

import { t } from '../../strings';
import '../style/together.css';
import { removePin } from '../../link/pins';
import type { Pin } from '../../wire/types';
import { CameraMarks } from '../../view/camera_marks';
import { PinView } from '../../view/pin_view';
import type { Viewer } from '../../view/viewer';
import { Vector3 } from 'three';
import { h, setText } from '../dom';
import { sentence } from '../format';
import type { TogetherParts } from './host';
import type { TogetherHost } from './host';
import { PinSetter } from './pin_setter';
import { saveFile, savePicture } from './save_picture';
import { SharedViews } from './shared_views';

const SETTLE_EVERY_MS = 500;

export class TogetherPanel {
  private readonly marks_: PinView;
  private readonly setter_: PinSetter;
  private readonly views_: SharedViews;
  private video_: AbortController | null = null;
  private shownPins_ = -1;
  private settledMs_ = -Infinity;

  constructor(
    private readonly host: TogetherHost,
    private readonly viewer: Viewer,
    private readonly parts: TogetherParts,
  ) {
    this.marks_ = new PinView(viewer, host.overlay);
    this.setter_ = new PinSetter(host, viewer, parts.pin);
    this.views_ = new SharedViews(host, viewer, new CameraMarks(viewer, host.overlay), parts);
  }

  update(): void {
    const { together } = this.host.model;
    if (this.shownPins_ !== together.pinChanges) {
      this.shownPins_ = together.pinChanges;
      this.marks_.show(together.pins);
      this.parts.pins.replaceChildren(...together.pins.map((pin) => this.row_(pin)));
    }
    const now = performance.now();
    if (now - this.settledMs_ > SETTLE_EVERY_MS) {
      this.settledMs_ = now;
      this.marks_.settle();
    }
    this.setter_.update();
    this.views_.update();
  }

  setPin(): void {
    this.setter_.toggle();
  }

  share(): void {
    this.views_.share();
  }

  savePicture(): void {
    const { host, viewer } = this;
    host.picture
      .withExactTiles(() => savePicture(viewer, host.model.welcome?.name ?? host.session))
      .catch((problem: unknown) => host.say(sentence((problem as Error).message)));
  }

  /** Pressed again, it ends without a file. */
  saveVideo(): void {
    if (this.video_) this.video_.abort();
    else void this.record_();
  }

  private async record_(): Promise<void> {
    const { host, viewer, parts } = this;
    const { signal } = (this.video_ = new AbortController());
    const name = parts.video.textContent;
    const tell = (share: number): void =>
      setText(parts.video, t('Cancel video, {0} %', Math.round(100 * share)));
    try {
      tell(0);
      const { turntableOf } = await import('./turntable');
      const file = await host.picture.withExactTiles(() => turntableOf(viewer, tell, signal));
      saveFile(file, host.model.welcome?.name ?? host.session, '.mp4');
    } catch (problem) {
      if (!signal.aborted) host.say(sentence((problem as Error).message));
    }
    setText(parts.video, name);
    this.video_ = null;
  }

  private row_(pin: Pin): HTMLElement {
    const { host } = this;
    const go = h(
      'button',
      { type: 'button', class: 'pin-go', title: t('Look at this spot') },
      h('span', { class: 'pin-words' }, pin.text),
      h('small', {}, pin.author),
    );
    go.addEventListener('click', () => this.lookAt_(pin));
    const item = h('li', { class: 'pin' }, go);
    const { welcome } = host.model;
    const isOwn = pin.author === host.name();
    const may = (action: string): boolean =>
      welcome?.may === undefined || welcome.may.includes(action);
    if (may('moderate') || (isOwn && may('place_pins'))) {
      const remove = h(
        'button',
        {
          type: 'button',
          class: 'quiet-action',
          'aria-label': t('Remove the pin “{0}”', pin.text),
        },
        t('Remove'),
      );
      remove.addEventListener('click', () => {
        removePin(host.session, pin.pin).catch((problem: unknown) =>
          host.say(sentence((problem as Error).message)),
        );
      });
      item.append(remove);
    }
    return item;
  }

  /** Flies to where the pin is seen from outside, as far away as the camera is now. */
  private lookAt_(pin: Pin): void {
    const { rig } = this.viewer;
    const place = new Vector3(...(this.marks_.placeOf(pin.pin) ?? pin.at_mm));
    const arm = rig.camera.position.clone().sub(rig.controls.target);
    const distance = Math.min(arm.length(), rig.closeMm);
    const from = arm
      .normalize()
      .multiplyScalar(0.7)
      .add(new Vector3(...pin.normal))
      .normalize();
    rig.view(place.clone().addScaledVector(from, distance), place, performance.now());
  }
}
