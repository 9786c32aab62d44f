// SPDX-License-Identifier: Apache-2.0

import type { SessionModel } from '../../model/session';
import type { ProgramInfo } from '../../wire/types';
import type { OneOpen } from '../one_open';
import type { PathHost } from './path_control';

/** The parts of the page that the panel uses. */
export interface ProgramsPanelHost {
  model: SessionModel;
  session: string;
  /** The picture, into which the panel draws the path; missing: it draws none. */
  path?: PathHost;
  /** Closes the panel when another part opens. */
  oneOpen?: OneOpen;
  /** The panel was opened or closed, and covers another part of the picture. */
  layoutChanged?: () => void;
  /** Shows the cuts of a program again; missing: the panel does not offer it. */
  replay?: (program: ProgramInfo) => void;
}

/** The parts of the page that the button and its panel use. */
export interface ProgramsHost extends Required<ProgramsPanelHost> {
  toolbar: HTMLElement;
}
