// SPDX-License-Identifier: Apache-2.0

import type { SessionModel } from '../model/session';
import type { OneOpen } from '../ui/one_open';
import type { Picture } from '../ui/picture';
import type { Shell } from '../ui/shell';
import type { AgentLink, CarveLinkEvents } from './carve_link';

/** The parts of the page that carving uses. */
export interface CarveHost {
  model: SessionModel;
  session: string;
  /** Under which this viewer is in the session, also where the list of people leaves viewers out. */
  name: () => string;
  picture: Picture;
  canvas: HTMLElement;
  /** Over the picture; does not take the pointer. */
  overlay: HTMLElement;
  shell: Shell;
  oneOpen: OneOpen;
  /** Makes the link to a block that the page itself carves; missing: a server does. */
  linkHere?: (events: CarveLinkEvents) => AgentLink;
  /** Says why something is not done. */
  say: (text: string) => void;
  /** Carving begins: the picture is to show the present. */
  begins: () => void;
  /** Does the page's work of one frame. */
  frame: (nowMs: number) => void;
}
