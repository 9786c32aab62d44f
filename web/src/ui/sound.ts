// SPDX-License-Identifier: Apache-2.0
// The button that turns sound on and off. Off by default: browsers play nothing without a gesture,
// and a page must not make noise unasked. Silent while the page is hidden.

import type { SoundLevels } from '../model/sound';
import type { SoundOutput } from '../view/sound_output';
import { iconButton } from './dom';
import { ICONS } from './icons';

const UPDATE_MS = 50;

export class SoundToggle {
  readonly button: HTMLButtonElement;
  private on_ = false;
  private timer_: ReturnType<typeof setInterval> | undefined;
  private context_: AudioContext | null = null;
  private output_: SoundOutput | null = null;

  /** `levels` returns what to play now. */
  constructor(private readonly levels: () => SoundLevels) {
    this.button = iconButton(ICONS.sound, 'Sound', 'S', () => this.toggle());
    this.button.setAttribute('aria-pressed', 'false');
    document.addEventListener('visibilitychange', () => this.follow_());
  }

  toggle(): void {
    this.on_ = !this.on_;
    this.button.setAttribute('aria-pressed', String(this.on_));
    if (!this.context_) {
      const context = new AudioContext(); // within the gesture, as browsers demand
      this.context_ = context;
      void import('../view/sound_output').then(({ SoundOutput }) => {
        this.output_ = new SoundOutput(context);
      });
    }
    this.follow_();
  }

  /** State of the audio context and present gains, for tests; null before sound was turned on. */
  get state(): { context: AudioContextState; tone: number; noise: number; loudest: number } | null {
    if (!this.context_ || !this.output_) return null;
    return { context: this.context_.state, ...this.output_.gains };
  }

  private follow_(): void {
    const plays = this.on_ && !document.hidden;
    void (plays ? this.context_?.resume() : this.context_?.suspend());
    clearInterval(this.timer_);
    // A timer of its own: sound follows the tools also where pictures are slow.
    if (plays) this.timer_ = setInterval(() => this.output_?.set(this.levels()), UPDATE_MS);
  }
}
