// SPDX-License-Identifier: Apache-2.0
// Pins on the surface, views that other viewers follow, pictures and videos of the block.

import { effect } from '@preact/signals';
import type { VNode } from 'preact';
import '../style/together.css';
import { removePin } from '../../link/pins';
import type { Pin } from '../../wire/types';
import { CameraMarks } from '../../view/camera_marks';
import { PinView } from '../../view/pin_view';
import type { Viewer } from '../../view/viewer';
import { Vector3 } from 'three';
import { sentence } from '../format';
import type { TogetherHost } from './host';
import { PinSetter } from './pin_setter';
import { CameraRows, PinRows } from './rows';
import { saveAs, savePicture } from './save_picture';
import { SharedViews } from './shared_views';
import type { TogetherState } from './state';

const SETTLE_EVERY_MS = 500;

export class TogetherPanel {
  private readonly marks_: PinView;
  private readonly setter_: PinSetter;
  private readonly views_: SharedViews;
  private video_: AbortController | null = null;
  private settledMs_ = -Infinity;

  constructor(
    private readonly host: TogetherHost,
    private readonly viewer: Viewer,
    private readonly state: TogetherState,
  ) {
    this.marks_ = new PinView(viewer, host.shell.overlay);
    this.setter_ = new PinSetter(host, viewer);
    this.views_ = new SharedViews(host, viewer, new CameraMarks(viewer, host.shell.overlay), state);
    effect(() => this.marks_.show(host.model.together.pins));
  }

  /** Samples the picture; called about ten times a second. */
  update(): void {
    const now = performance.now();
    if (now - this.settledMs_ > SETTLE_EVERY_MS) {
      this.settledMs_ = now;
      this.marks_.settle();
    }
    this.setter_.update();
    this.views_.update();
  }

  /** The list of shared views. */
  cameraRows(): VNode {
    return <CameraRows views={this.views_} />;
  }

  /** The list of pins. */
  pinRows(): VNode {
    return (
      <PinRows
        host={this.host}
        lookAt={(pin) => this.lookAt_(pin)}
        remove={(pin) => this.remove_(pin)}
      />
    );
  }

  /** The dialog for the text of a pin. */
  dialog(): VNode {
    return this.setter_.dialog();
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
    const { host, viewer, state } = this;
    const { signal } = (this.video_ = new AbortController());
    const tell = (share: number): void => void (state.recorded.value = share);
    try {
      tell(0);
      const { turntableOf } = await import('./turntable');
      const file = await host.picture.withExactTiles(() => turntableOf(viewer, tell, signal));
      saveAs(file, host.model.welcome?.name ?? host.session, '.mp4');
    } catch (problem) {
      if (!signal.aborted) host.say(sentence((problem as Error).message));
    }
    state.recorded.value = null;
    this.video_ = null;
  }

  private remove_(pin: Pin): void {
    const { host } = this;
    removePin(host.session, pin.pin).catch((problem: unknown) =>
      host.say(sentence((problem as Error).message)),
    );
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
