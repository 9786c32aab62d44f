// SPDX-License-Identifier: Apache-2.0
// The sentence in the bar while one carves: an event for a short time, else the state.

import { signal } from '@preact/signals';

const NOTE_MS = 6000;

/** `isProblem`: something did not work. */
export interface Note {
  text: string;
  isProblem: boolean;
}

export class Notes {
  private readonly shown_ = signal<Note>({ text: '', isProblem: false });
  private untilMs_ = 0;

  /** The sentence, as a signal's value. */
  get shown(): Note {
    return this.shown_.value;
  }

  /** Reports an event. */
  say(text: string, isProblem = false): void {
    this.untilMs_ = performance.now() + NOTE_MS;
    this.show(text, isProblem);
  }

  /** Shows a state, in place of an event too. */
  show(text: string, isProblem = false): void {
    const before = this.shown_.peek();
    if (text !== before.text || isProblem !== before.isProblem)
      this.shown_.value = { text, isProblem };
  }

  /** Shows a state once the last event was shown long enough. */
  showLater(text: string, nowMs: number): void {
    if (nowMs > this.untilMs_) this.show(text);
  }

  /** The last event counts no more. */
  forget(): void {
    this.untilMs_ = 0;
  }
}
