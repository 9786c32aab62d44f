// SPDX-License-Identifier: Apache-2.0
// Sets a pin: the next press on the block gives its point, a dialog its text.

import { effect, signal } from '@preact/signals';
import { render } from 'preact';
import { t } from '../../strings';
import { PIN_BYTES_MAX, setPin } from '../../link/pins';
import { firstBehind } from '../../model/section';
import { hitsOf } from '../../model/surface';
import type { Viewer } from '../../view/viewer';
import type { Vec3 } from '../../wire/types';
import { h } from '../dom';
import { sentence } from '../format';
import type { TogetherHost } from './host';
import type { TogetherState } from './state';

const TAP_PX = 5;
const HINT = t('Click a spot on the block. Esc cancels.');

interface FormProps {
  text: string;
  write: (text: string) => void;
  save: () => void;
  cancel: () => void;
}

function PinForm({ text, write, save, cancel }: FormProps) {
  return (
    <form method="dialog" onSubmit={save}>
      <h2>{t('What do you want to say here?')}</h2>
      <input
        class="pin-input"
        aria-label={t('Pin text')}
        maxLength={PIN_BYTES_MAX}
        required
        autocomplete="off"
        value={text}
        onInput={({ currentTarget }) => write(currentTarget.value)}
      />
      <div class="history-actions">
        <button class="history-button">{t('Add pin')}</button>
        <button type="button" class="history-button" onClick={cancel}>
          {t('Cancel')}
        </button>
      </div>
    </form>
  );
}

export class PinSetter {
  private pressedAt_: { x: number; y: number } | null = null;
  private at_: { point: Vec3; normal: Vec3 } | null = null;
  private readonly text_ = signal('');
  private readonly close_ = (): void => this.aim_(false);
  private readonly dialog_ = h('dialog', {
    class: 'help pin-dialog',
    'aria-label': t('Pin text'),
  });

  constructor(
    private readonly host: TogetherHost,
    private readonly viewer: Viewer,
    private readonly state: TogetherState,
  ) {
    this.main_.append(this.dialog_);
    effect(() => this.show_());
    effect(() => void host.canvas.classList.toggle('aims', state.isAiming.value));
    this.listen_();
  }

  toggle(): void {
    this.aim_(!this.state.isAiming.value);
  }

  /** Keeps the hint in view. */
  update(): void {
    if (this.state.isAiming.value) this.host.say(HINT);
  }

  private get main_(): Element {
    return this.host.canvas.closest('main') ?? document.body;
  }

  private show_(): void {
    render(
      <PinForm
        text={this.text_.value}
        write={(text) => (this.text_.value = text)}
        save={() => this.save_()}
        cancel={() => this.dialog_.close()}
      />,
      this.dialog_,
    );
  }

  private aim_(aims: boolean): void {
    const { isAiming } = this.state;
    if (aims === isAiming.value) return;
    isAiming.value = aims;
    this.host.say(aims ? HINT : '');
    if (!aims) {
      this.host.oneOpen.closed(this.close_);
      return;
    }
    this.host.oneOpen.opens(this.close_);
    // On phones the sheet covers the block.
    this.main_.querySelector<HTMLElement>('.panel.open .sheet-handle')?.click();
  }

  private listen_(): void {
    const { canvas } = this.host;
    canvas.addEventListener('pointerdown', (event) => {
      this.pressedAt_ = event.isPrimary ? { x: event.offsetX, y: event.offsetY } : null;
    });
    canvas.addEventListener('pointerup', (event) => {
      const { pressedAt_: at } = this;
      if (!this.state.isAiming.value || !at || event.button !== 0) return;
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
    this.dialog_.showModal();
    this.dialog_.querySelector('input')?.focus();
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
