// SPDX-License-Identifier: Apache-2.0

import type { SessionModel } from '../../model/session';
import type { Seek } from '../../wire/types';
import type { Picture } from '../picture';
import type { Shell } from '../shell';

/** The parts of the page that the timeline uses. */
export interface TimelineHost {
  model: SessionModel;
  session: string;
  picture: Picture;
  shell: Shell;
  seek: (seek: Seek) => void;
}
