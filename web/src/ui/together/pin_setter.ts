// SPDX-License-Identifier: Apache-2.0
// Sets a pin: the next press on the block gives its place, a dialog its text.

import { t } from '../../strings';
import { PIN_BYTES_MAX, setPin } from '../../link/pins';
import { firstBehind } from '../../model/section';
import { hitsOf } from '../../model/surface';
import type { Viewer } from '../../view/viewer';
import type { Vec3 } from '../../wire/types';
import { h } from '../dom';
import { sentence } from '../format';
import type { TogetherHost } from './host';

const TAP_PX = 5;
const HINT = t('Click a spot on the block. Esc cancels.');

export class PinSetter {
  private isWaiting_ = false;
  private pressedAt_: { x: number; y: number } | null = null;
  private place_: { point: Vec3; normal: Vec3 } | null = null;
  private readonly close_ = (): void => this.wait_(false);
  private readonly input_ = h('input', {
    class: 'pin-input',
    'aria-label': t('Pin text'),
    maxlength: String(PIN_BYTES_MAX),
    required: '',
    autocomplete: 'off',
  });
  private readonly dialog_: HTMLDialogElement;

  constructor(
    private readonly host: TogetherHost,
    private readonly viewer: Viewer,
    private readonly opener: HTMLElement,
  ) {
    opener.setAttribute('aria-pressed', 'false');
    const cancel = h('button', { type: 'button', class: 'history-button' }, t('Cancel'));
    cancel.addEventListener('click', () => this.dialog_.close());
    const form = h(
      'form',
      { method: 'dialog' },
      h('h2', {}, t('What do you want to say here?')),
      this.input_,
      h(
        'div',
        { class: 'history-actions' },
        h('button', { class: 'history-button' }, t('Add pin')),
        cancel,
      ),
    );
    form.addEventListener('submit', () => this.save_());
    this.dialog_ = h('dialog', { class: 'help pin-dialog', 'aria-label': t('Pin text') }, form);
    this.main_.append(this.dialog_);
    this.listen_();
  }

  toggle(): void {
    this.wait_(!this.isWaiting_);
  }

  /** Keeps the hint in view. */
  update(): void {
    if (this.isWaiting_) this.host.say(HINT);
  }

  private get main_(): Element {
    return this.host.canvas.closest('main') ?? document.body;
  }

  private wait_(waits: boolean): void {
    if (waits === this.isWaiting_) return;
    this.isWaiting_ = waits;
    this.opener.setAttribute('aria-pressed', String(waits));
    this.host.canvas.classList.toggle('aims', waits);
    this.host.say(waits ? HINT : '');
    if (!waits) {
      this.host.oneOpen.closed(this.close_);
      return;
    }
    this.host.oneOpen.opens(this.close_);
    // On phones the sheet lies over the block.
    this.main_.querySelector<HTMLElement>('.panel.open .sheet-handle')?.click();
  }

  private listen_(): void {
    const { canvas } = this.host;
    canvas.addEventListener('pointerdown', (event) => {
      this.pressedAt_ = event.isPrimary ? { x: event.offsetX, y: event.offsetY } : null;
    });
    canvas.addEventListener('pointerup', (event) => {
      const { pressedAt_: at } = this;
      if (!this.isWaiting_ || !at || event.button !== 0) return;
      if (Math.hypot(event.offsetX - at.x, event.offsetY - at.y) < TAP_PX)
        this.press_(event.offsetX, event.offsetY);
    });
    window.addEventListener('keydown', (event) => {
      if (event.key === 'Escape') this.wait_(false);
    });
  }

  private press_(x: number, y: number): void {
    const ray = this.viewer.ray(x, y);
    const [origin, direction] = [ray.origin.toArray(), ray.direction.toArray()];
    const { displayed } = this.viewer;
    const hit = firstBehind(hitsOf(displayed.pieces, origin, direction), origin, direction, null);
    if (!hit) return;
    this.place_ = hit;
    this.wait_(false);
    this.input_.value = '';
    this.dialog_.showModal();
    this.input_.focus();
  }

  private save_(): void {
    const text = this.input_.value.trim();
    if (!this.place_ || text === '') return;
    const { point, normal } = this.place_;
    const { session, name, say } = this.host;
    setPin(session, text, point, normal, name()).catch((problem: unknown) =>
      say(sentence((problem as Error).message)),
    );
  }
}
