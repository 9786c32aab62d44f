// SPDX-License-Identifier: Apache-2.0
// A 3D mouse moves the camera while no tool is in hand: its settings, and its step of a frame.

import { signal } from '@preact/signals';
import { useMemo } from 'preact/hooks';
import { t } from '../../strings';
import type { Hid, SpaceMouse } from './space_mouse';
import { cameraStep } from '../../model/cap_push';
import type { CapSense } from '../../model/cap_push';
import { recall, remember } from '../../strings/memory';
import type { CameraRig } from '../../view/camera_rig';

const KEY = 'space-mouse';
const OFF = 'off';

export interface CapMouseHost {
  rig: () => Pick<CameraRig, 'orbit' | 'pan' | 'zoom' | 'fit'> | undefined;
  /** Whether it moves something else now, such as a tool. */
  isBusy: () => boolean;
  say: (text: string) => void;
}

export class CapMouse {
  /** Whether one is open, and there. */
  readonly isOn = signal(false);
  readonly sense = signal<CapSense>('block');
  private mouse_: SpaceMouse | null = null;
  private isOpen_ = false;
  private lastMs_ = 0;

  constructor(
    private readonly host: CapMouseHost,
    private readonly hid: Hid,
  ) {
    const known = recall(KEY);
    if (known === 'camera') this.sense.value = known;
    if (known !== null && known !== OFF) void this.start_(false);
  }

  /** Turns it off if it is on; otherwise the user chooses one. */
  async toggle(): Promise<void> {
    if (!this.isOpen_ || !this.mouse_?.isThere) {
      await this.start_(true);
      return;
    }
    this.isOpen_ = false;
    remember(KEY, OFF);
    this.check_();
  }

  choose(sense: CapSense): void {
    this.sense.value = sense;
    remember(KEY, sense);
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
    if (asks) remember(KEY, this.sense.peek());
    if (!this.isOpen_) requestAnimationFrame((nowMs) => this.tick_(nowMs));
    this.isOpen_ = true;
    this.check_();
  }

  private tick_(nowMs: number): void {
    if (!this.isOpen_) return;
    requestAnimationFrame((next) => this.tick_(next));
    this.check_();
    const timeS = (nowMs - this.lastMs_) / 1000;
    this.lastMs_ = nowMs;
    const read = this.mouse_!.read();
    const rig = this.host.rig();
    // In another window it is for that one.
    if (!rig || this.host.isBusy() || !document.hasFocus()) return;
    if (read.presses.includes('next')) rig.fit(nowMs);
    const step = cameraStep(read, this.sense.peek(), timeS);
    if (!step) return;
    rig.orbit(step.aroundRad, step.upRad);
    rig.pan(step.panRight, step.panUp);
    rig.zoom(step.zoom);
  }

  /** It may be unplugged at any time. */
  private check_(): void {
    this.isOn.value = this.isOpen_ && this.mouse_?.isThere === true;
  }
}

/** The settings of a 3D mouse. */
export function CapMouseSettings({ mouse }: { mouse: CapMouse }) {
  const isOn = mouse.isOn.value;
  return (
    <div class="navigation">
      <button
        type="button"
        class="quiet-action"
        title={t('The cap moves the view, the right button shows the whole block')}
        aria-pressed={isOn}
        onClick={() => void mouse.toggle()}
      >
        {t('3D mouse')}
      </button>
      <select
        class="language"
        aria-label={t('What the 3D mouse moves')}
        hidden={!isOn}
        value={mouse.sense.value}
        onChange={({ currentTarget }) => mouse.choose(currentTarget.value as CapSense)}
      >
        <option value="block">{t('moves the block')}</option>
        <option value="camera">{t('moves the camera')}</option>
      </select>
    </div>
  );
}

/** The same where the browser can have one; nothing elsewhere. */
export function CapMouseChoice({ host }: { host: CapMouseHost }) {
  const mouse = useMemo(() => {
    const { hid } = navigator as { hid?: Hid };
    return hid ? new CapMouse(host, hid) : null;
  }, []);
  return mouse && <CapMouseSettings mouse={mouse} />;
}
