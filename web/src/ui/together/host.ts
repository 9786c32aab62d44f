// SPDX-License-Identifier: Apache-2.0

import type { SessionModel } from '../../model/session';
import type { CameraPose } from '../../wire/types';
import type { OneOpen } from '../one_open';
import type { Picture } from '../picture';

/** The parts of the page that the section uses. */
export interface TogetherHost {
  model: SessionModel;
  session: string;
  /** The viewer's name. */
  name: () => string;
  picture: Picture;
  canvas: HTMLCanvasElement;
  /** Over the picture, for elements that follow the block. */
  overlay: HTMLElement;
  oneOpen: OneOpen;
  /** Shows the viewer's camera to others; null: no longer. */
  showCamera: (pose: CameraPose | null) => void;
  /** Shows a sentence for some seconds. */
  say: (text: string) => void;
}
