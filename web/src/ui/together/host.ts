// SPDX-License-Identifier: Apache-2.0

import type { SessionModel } from '../../model/session';
import type { CameraPose } from '../../wire/types';
import type { OneOpen } from '../one_open';
import type { Picture } from '../picture';
import type { Shell } from '../shell';

/** The parts of the page that the section uses. */
export interface TogetherHost {
  model: SessionModel;
  session: string;
  /** The viewer's name. */
  name: () => string;
  picture: Picture;
  shell: Shell;
  oneOpen: OneOpen;
  /** Shows the viewer's camera to others; null: no longer. */
  showCamera: (pose: CameraPose | null) => void;
  /** Shows a sentence for some seconds. */
  say: (text: string) => void;
}
