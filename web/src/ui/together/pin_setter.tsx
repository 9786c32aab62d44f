// SPDX-License-Identifier: Apache-2.0
// Sets a pin: the next press on the block gives its point, a dialog its text.

import { signal } from '@preact/signals';
import type { Signal } from '@preact/signals';
import type { VNode } from 'preact';
import { t } from '../../strings';
import { PIN_BYTES_MAX, setPin } from '../../link/pins';
import { firstBehind } from '../../model/section';
import { hitsOf } from '../../model/surface';
import type { Viewer } from '../../view/viewer';
import type { Vec3 } from '../../wire/types';
import { Dialog } from '../dialog';
import { sentence } from '../format';
import type { TogetherHost } from './host';

const TAP_PX = 5;
const HINT = t('Click a spot on the block. Esc cancels.');

interface DialogProps {
  isOpen: Signal<boolean>;
  text: Signal<string>;
  save: () => void;
}

function PinDialog({ isOpen, text, save }: DialogProps) {
  return (
    <Dialog class="help pin-dialog" label={t('Pin text')} isOpen={isOpen}>
      <form method="dialog" onSubmit={save}>
        <h2>{t('What do you want to say here?')}</h2>
        <input
          class="pin-input"
          aria-label={t('Pin text')}
          maxLength={PIN_BYTES_MAX}
          required
          autofocus
          autocomplete="off"
          value={text.value}
          onInput={({ currentTarget }) => (text.value = currentTarget.value)}
        />
        <div class="history-actions">
          <button class="history-button">{t('Add pin')}</button>
          <button type="button" class="history-button" onClick={() => (isOpen.value = false)}>
            {t('Cancel')}
          </button>
        </div>
      </form>
    </Dialog>
  );
}

export class PinSetter {
  private pressedAt_: { x: number; y: number } | null = null;
  private at_: { point: Vec3; normal: Vec3 } | null = null;
  private readonly text_ = signal('');
  private readonly close_ = (): void => this.aim_(false);
  private readonly isFormOpen_ = signal(false);

  constructor(
    private readonly host: TogetherHost,
    private readonly viewer: Viewer,
  ) {
    this.listen_();
  }

  toggle(): void {
    this.aim_(!this.host.shell.isAiming.value);
  }

  /** Keeps the hint in view. */
  update(): void {
    if (this.host.shell.isAiming.value) this.host.say(HINT);
  }

  dialog(): VNode {
    return <PinDialog isOpen={this.isFormOpen_} text={this.text_} save={() => this.save_()} />;
  }

  private aim_(aims: boolean): void {
    const { isAiming } = this.host.shell;
    if (aims === isAiming.value) return;
    isAiming.value = aims;
    this.host.say(aims ? HINT : '');
    if (!aims) {
      this.host.oneOpen.closed(this.close_);
      return;
    }
    this.host.oneOpen.opens(this.close_);
    this.host.shell.isSheetOpen.value = false; // on phones it covers the block
  }

  private listen_(): void {
    const { canvas } = this.host.shell;
    canvas.addEventListener('pointerdown', (event) => {
      this.pressedAt_ = event.isPrimary ? { x: event.offsetX, y: event.offsetY } : null;
    });
    canvas.addEventListener('pointerup', (event) => {
      const { pressedAt_: at } = this;
      if (!this.host.shell.isAiming.value || !at || event.button !== 0) return;
      if (Math.hypot(event.offsetX - at.x, event.offsetY - at.y) < TAP_PX)
        this.press_(event.offsetX, event.offsetY);
    });
    window.addEventListener('keydown', (event) => {
      if (event.key === 'Escape') this.aim_(false);
    });
  }

  private press_(x: number, y: number): void {
    const ray = this.viewer.ray(x, y);
    const [origin, direction] = [ray.origin.toArray(), ray.direction.toArray()];
    const { displayed } = this.viewer;
    const hit = firstBehind(hitsOf(displayed.pieces, origin, direction), origin, direction, null);
    if (!hit) return;
    this.at_ = hit;
    this.aim_(false);
    this.text_.value = '';
    this.isFormOpen_.value = true;
  }

  private save_(): void {
    const text = this.text_.value.trim();
    if (!this.at_ || text === '') return;
    const { point, normal } = this.at_;
    const { session, name, say } = this.host;
    setPin(session, text, point, normal, name()).catch((problem: unknown) =>
      say(sentence((problem as Error).message)),
    );
  }
}
