// SPDX-License-Identifier: Apache-2.0
// A 3D mouse moves the camera while no tool is in hand: its settings, and its step of a frame.

import { t } from '../../strings';
import type { Hid, SpaceMouse } from './space_mouse';
import { cameraStep } from '../../model/cap_push';
import type { CapSense } from '../../model/cap_push';
import { recall, remember } from '../../strings/memory';
import type { CameraRig } from '../../view/camera_rig';
import { h } from '../../ui/dom';

const KEY = 'space-mouse';
const OFF = 'off';

export interface CapMouseHost {
  rig: () => Pick<CameraRig, 'orbit' | 'pan' | 'zoom' | 'fit'> | undefined;
  /** Whether it moves something else now, such as a tool. */
  isBusy: () => boolean;
  say: (text: string) => void;
}

export class CapMouse {
  private readonly button_ = h(
    'button',
    {
      type: 'button',
      class: 'quiet-action',
      title: t('The cap moves the view, the right button shows the whole block'),
    },
    t('3D mouse'),
  );
  private readonly sense_ = h(
    'select',
    { class: 'language', 'aria-label': t('What the 3D mouse moves') },
    h('option', { value: 'block' }, t('moves the block')),
    h('option', { value: 'camera' }, t('moves the camera')),
  );
  readonly element = h('div', { class: 'navigation' }, this.button_, this.sense_);
  private mouse_: SpaceMouse | null = null;
  private isOn_ = false;
  private lastMs_ = 0;

  constructor(
    private readonly host: CapMouseHost,
    private readonly hid: Hid,
  ) {
    const known = recall(KEY);
    this.sense_.value = known === 'camera' ? 'camera' : 'block';
    this.button_.addEventListener('click', () => void this.press_());
    this.sense_.addEventListener('change', () => remember(KEY, this.sense_.value));
    this.show_();
    if (known !== null && known !== OFF) void this.start_(false);
  }

  /** Opened, it is turned off; else the user chooses one. */
  private async press_(): Promise<void> {
    if (!this.isOn_ || !this.mouse_?.isThere) {
      await this.start_(true);
      return;
    }
    this.isOn_ = false;
    remember(KEY, OFF);
    this.show_();
  }

  private async start_(asks: boolean): Promise<void> {
    try {
      const { SpaceMouse } = await import('./space_mouse');
      this.mouse_ ??= new SpaceMouse(this.hid);
      await this.mouse_.open(asks);
    } catch (problem) {
      this.host.say(t('The 3D mouse could not be opened: {0}', (problem as Error).message));
      return;
    }
    if (asks && !this.mouse_.isThere) return; // the user has chosen none
    if (asks) remember(KEY, this.sense_.value);
    if (!this.isOn_) requestAnimationFrame((nowMs) => this.tick_(nowMs));
    this.isOn_ = true;
    this.show_();
  }

  private tick_(nowMs: number): void {
    if (!this.isOn_) return;
    requestAnimationFrame((next) => this.tick_(next));
    this.show_();
    const timeS = (nowMs - this.lastMs_) / 1000;
    this.lastMs_ = nowMs;
    const read = this.mouse_!.read();
    const rig = this.host.rig();
    // In another window it is for that one.
    if (!rig || this.host.isBusy() || !document.hasFocus()) return;
    if (read.presses.includes('next')) rig.fit(nowMs);
    const step = cameraStep(read, this.sense_.value as CapSense, timeS);
    if (!step) return;
    rig.orbit(step.aroundRad, step.upRad);
    rig.pan(step.panRight, step.panUp);
    rig.zoom(step.zoom);
  }

  /** It may be unplugged at any time. */
  private show_(): void {
    const pressed = String(this.isOn_ && this.mouse_?.isThere === true);
    if (this.button_.getAttribute('aria-pressed') === pressed) return;
    this.button_.setAttribute('aria-pressed', pressed);
    this.sense_.hidden = pressed === 'false';
  }
}

/** Null where the browser can have none. */
export function capMouse(host: CapMouseHost): HTMLElement | null {
  const { hid } = navigator as { hid?: Hid };
  return hid ? new CapMouse(host, hid).element : null;
}
