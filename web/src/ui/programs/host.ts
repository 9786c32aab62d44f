// SPDX-License-Identifier: Apache-2.0

import type { SessionModel } from '../../model/session';
import type { ProgramInfo } from '../../wire/types';
import type { OneOpen } from '../one_open';
import type { Shell } from '../shell';
import type { PathHost } from './path_control';

/** The parts of the page that the panel uses. */
export interface ProgramsPanelHost {
  model: SessionModel;
  session: string;
  /** The picture, into which the panel draws the path; missing: it draws none. */
  path?: PathHost;
  /** Closes the panel when another part opens. */
  oneOpen?: OneOpen;
  shell: Shell;
  /** Shows the cuts of a program again; missing: the panel does not offer it. */
  replay?: (program: ProgramInfo) => void;
}

/** All of them: the panel of a whole page. */
export type ProgramsHost = Required<ProgramsPanelHost>;
