// SPDX-License-Identifier: Apache-2.0

import type { ProgramPlace } from '../../model/program_place';
import type { SessionModel } from '../../model/session';
import type { OneOpen } from '../one_open';
import type { Picture } from '../picture';
import type { Shell } from '../shell';

/** The parts of the page that the panel uses. */
export interface InspectHost {
  model: SessionModel;
  /** Null: without a server. */
  session: string | null;
  picture: Picture;
  canvas: HTMLCanvasElement;
  /** Over the picture, for elements that follow the block. */
  overlay: HTMLElement;
  shell: Shell;
  oneOpen: OneOpen;
  /** Shows a line in the panel of programs; missing: there is no such panel. */
  showLine?: (place: ProgramPlace) => void;
}
