// SPDX-License-Identifier: Apache-2.0

import type { SessionModel } from '../../model/session';
import type { Seek } from '../../wire/types';
import type { Picture } from '../picture';

/** The parts of the page that the timeline uses. */
export interface TimelineHost {
  model: SessionModel;
  session: string;
  picture: Picture;
  toolbar: HTMLElement;
  seek: (seek: Seek) => void;
  /** The timeline was opened or closed, and covers another part of the picture. */
  layoutChanged: () => void;
}
