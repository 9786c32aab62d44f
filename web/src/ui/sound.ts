// SPDX-License-Identifier: Apache-2.0
// Sound and the action that turns it on and off. Off by default: browsers play nothing without a
// gesture, and a page must not make noise unasked. Silent while the page is hidden.

import { signal } from '@preact/signals';
import { t } from '../strings';
import type { SoundLevels } from '../model/sound';
import type { SoundOutput } from '../view/sound_output';
import type { ButtonAction } from './actions';
import { ICONS } from './icons';

const UPDATE_MS = 50;

/** Loads the code that plays, in a chunk of its own. */
async function createOutput(context: AudioContext): Promise<SoundOutput> {
  const { SoundOutput } = await import('../view/sound_output');
  return new SoundOutput(context);
}

export class Sound {
  readonly isOn = signal(false);
  readonly action: ButtonAction = {
    ...{ name: 'sound', label: t('Sound'), key: 'S', icon: ICONS.sound },
    isPressed: () => this.isOn.value,
    perform: () => this.toggle(),
  };
  private timer_: ReturnType<typeof setInterval> | undefined;
  private context_: AudioContext | null = null;
  private output_: SoundOutput | null = null;

  /** `levels` returns what to play now; `create` connects an output, for tests. */
  constructor(
    private readonly levels: () => SoundLevels,
    private readonly create = createOutput,
  ) {
    document.addEventListener('visibilitychange', () => this.follow_());
  }

  /** Turns sound on or off. Where sound cannot be had it stays off; the next call tries again. */
  toggle(): void {
    const isOn = this.isOn.peek();
    if (!isOn && !this.context_ && !this.open_()) return;
    this.turn_(!isOn);
  }

  /** State of the audio context and present gains, for tests; null before sound was turned on. */
  get state(): { context: AudioContextState; tone: number; noise: number; loudest: number } | null {
    if (!this.context_ || !this.output_) return null;
    return { context: this.context_.state, ...this.output_.gains };
  }

  /** Opens the audio device and loads the output. Returns false if there is no device. */
  private open_(): boolean {
    let context: AudioContext;
    try {
      context = new AudioContext(); // within the gesture, as browsers demand
    } catch (error) {
      console.warn('No sound:', error);
      return false;
    }
    this.context_ = context;
    this.create(context).then(
      (output) => {
        this.output_ = output;
      },
      (error: unknown) => {
        console.warn('No sound:', error);
        this.context_ = null;
        this.turn_(false);
        context.close().catch(() => undefined);
      },
    );
    return true;
  }

  private turn_(on: boolean): void {
    this.isOn.value = on;
    this.follow_();
  }

  private follow_(): void {
    const plays = this.isOn.peek() && !document.hidden;
    // Both reject where the device went away; the button then has no effect until it is back.
    const followed = plays ? this.context_?.resume() : this.context_?.suspend();
    followed?.catch(() => undefined);
    clearInterval(this.timer_);
    // A timer of its own: sound follows the tools also where pictures are slow.
    if (plays) this.timer_ = setInterval(() => this.output_?.set(this.levels()), UPDATE_MS);
  }
}
