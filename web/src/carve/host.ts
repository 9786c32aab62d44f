// SPDX-License-Identifier: Apache-2.0

import type { SessionModel } from '../model/session';
import type { NewTool } from '../model/tool_sizes';
import type { OneOpen } from '../ui/one_open';
import type { Picture } from '../ui/picture';
import type { Shell } from '../ui/shell';
import type { ToolInfo } from '../wire/types';
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
  /** Makes a tool in a block that the page itself carves; missing: the server does. */
  makeToolHere?: (tool: NewTool) => Promise<ToolInfo>;
  /** Says why something is not done. */
  say: (text: string) => void;
  /** Carving begins: the picture is to show the present. */
  begins: () => void;
  /** Does the page's work of one frame. */
  frame: (nowMs: number) => void;
}
