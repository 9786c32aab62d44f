// SPDX-License-Identifier: Apache-2.0
// The state of the section for pins, shared views and pictures.

import { signal } from '@preact/signals';

export class TogetherState {
  /** Whether this viewer's camera is shown to other viewers. */
  readonly isShared = signal(false);
  /** The viewer whose camera this page follows; null if it follows none. */
  readonly followed = signal<number | null>(null);
  /** Recorded share of the video, 0 to 1; null while no video is recorded. */
  readonly recorded = signal<number | null>(null);
}
