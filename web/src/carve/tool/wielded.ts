// SPDX-License-Identifier: Apache-2.0
// The tool for devices that are no pointers, such as the controllers of a headset, gamepads and 3D
// mice: they put it anywhere, with any axis.

import type { ToolInfo } from '../../wire/types';
import type { Pose } from './path_queue';

/** The tool that is chosen, out of the rack. */
export interface ToolChoice {
  readonly tool: ToolInfo | null;
  readonly tools: readonly ToolInfo[];
  readonly depthMm: number;
  chooseTool(id: number): void;
  /** Takes the next tool of the rack, or the one before. */
  nextTool(step: 1 | -1): void;
}

export interface Wielded {
  /** Why no stroke may begin now, as a sentence; empty: one may. */
  whyNot: () => string;
  readonly settings: ToolChoice;
  /** Moves the tool; `cuts`: on its path from where it was. */
  moveTo: (pose: Pose, cuts: boolean) => void;
  /** Ends a stroke where the tool is. */
  lift: () => void;
  /** Where the tool is; null: nowhere. */
  pose: () => Pose | null;
  undo: () => void;
  redo: () => void;
  /** On the tool now, N. */
  forceN: () => number;
  /** Tells the user. */
  say: (text: string) => void;
}
