// SPDX-License-Identifier: Apache-2.0
// The user's choices, shown in the bar: the tool, how it follows the pointer, and its depth.

import { signal } from '@preact/signals';
import { toolProfile } from '../model/tool_profile';
import type { ToolInfo, Welcome } from '../wire/types';
import { AXIS_CHOICES } from './aim';
import type { AimMode, AxisChoice } from './aim';
import { DRAG_STRENGTHS } from './drag';
import type { DragStrength } from './drag';
import { recall, remember } from '../strings/memory';
import type { Hand } from './hand';

const DEPTH_OF_RADIUS = 0.5; // at the start, of the tool's radius
const DEEPEST_RADII = 4;
const DRAG = 'drag'; // as it is remembered
const DEFAULT_DRAG: DragStrength = 'off'; // the tool is where the pointer is in the next frame

export interface SettingsHost {
  isJoined: () => boolean;
  /** Of the participant. */
  color: () => string;
  /** Another tool is taken: a stroke ends. */
  changes: () => void;
}

export class ToolSettings {
  private welcome_: Welcome | null = null; // for which the rack was filled
  readonly mode = signal<AimMode>('surface');
  readonly axis = signal<AxisChoice>('surface');
  readonly drag = signal<DragStrength>(DEFAULT_DRAG);
  /** The depth and its bounds, mm. */
  readonly depth = signal({ mm: 1, least: 0.1, most: 10 });
  private readonly tools_ = signal<readonly ToolInfo[]>([]);
  private readonly tool_ = signal<ToolInfo | null>(null);

  constructor(
    private readonly hand: Hand,
    private readonly host: SettingsHost,
  ) {}

  /** The chosen tool, as a signal's value. */
  get tool(): ToolInfo | null {
    return this.tool_.value;
  }

  /** The tools of the session, as a signal's value. */
  get tools(): readonly ToolInfo[] {
    return this.tools_.value;
  }

  get depthMm(): number {
    return this.depth.value.mm;
  }

  /** Fills the rack for a session that was joined, once. */
  prepare(welcome: Welcome): void {
    if (welcome === this.welcome_) return;
    this.welcome_ = welcome;
    const known = DRAG_STRENGTHS.find((one) => one === recall(DRAG));
    this.hold_(known ?? DEFAULT_DRAG);
    this.tools_.value = welcome.tools;
    const before = this.tool_.peek();
    const tool = welcome.tools.find(({ id }) => id === before?.id) ?? welcome.tools[0];
    if (!tool) return;
    if (!before)
      this.depth.value = {
        ...this.depth.peek(),
        mm: DEPTH_OF_RADIUS * toolProfile(tool).radiusMm,
      };
    this.chooseTool(tool.id);
    this.showMode_();
  }

  chooseTool(id: number): void {
    const tool = this.tools_.peek().find((one) => one.id === id);
    if (!tool) return;
    this.host.changes();
    // The hello names the first one.
    const before = this.tool_.peek();
    if (before && id !== before.id) this.hand.sampler.ask({ type: 'tool', tool: id });
    this.tool_.value = tool;
    this.hand.takeTool(tool, this.host.color(), this.welcome_!);
    this.setDepth(this.depth.peek().mm);
  }

  /** Takes the next tool of the rack, or the one before. */
  nextTool(step: 1 | -1): void {
    const ids = this.tools_.peek().map(({ id }) => id);
    const at = ids.indexOf(this.tool_.peek()?.id ?? 0) + step;
    const id = ids[(at + ids.length) % ids.length];
    if (id !== undefined) this.chooseTool(id);
  }

  chooseMode(mode: AimMode): void {
    this.hand.settings.mode = mode;
    this.showMode_();
  }

  togglePlane(): void {
    this.chooseMode(this.hand.settings.mode === 'plane' ? 'surface' : 'plane');
  }

  /** The next choice of the tool's axis. */
  nextAxis(): void {
    const { settings } = this.hand;
    const at = AXIS_CHOICES.indexOf(settings.axis) + 1;
    settings.axis = AXIS_CHOICES[at % AXIS_CHOICES.length]!;
    this.showMode_();
  }

  /** The next strength of the drag by the cutting force. */
  nextDrag(): void {
    const at = DRAG_STRENGTHS.indexOf(this.drag.peek()) + 1;
    this.hold_(DRAG_STRENGTHS[at % DRAG_STRENGTHS.length]!);
    remember(DRAG, this.drag.peek());
  }

  setDepth(mm: number): void {
    const tool = this.tool_.peek();
    if (!tool || !this.welcome_) return;
    const { lengthMm, radiusMm } = toolProfile(tool);
    const most = Math.min(lengthMm, DEEPEST_RADII * radiusMm);
    const least = Math.min(this.welcome_.pitch_mm, most / 2) / 2;
    this.depth.value = { mm: Math.min(most, Math.max(least, mm)), least, most };
    this.hand.settings.depthMm = this.depth.peek().mm;
    this.hand.hoverAgain(this.host.isJoined());
  }

  private hold_(strength: DragStrength): void {
    this.hand.drag.strength = strength;
    this.drag.value = strength;
  }

  private showMode_(): void {
    const { mode, axis } = this.hand.settings;
    this.mode.value = mode;
    this.axis.value = axis;
    this.hand.hoverAgain(this.host.isJoined());
  }
}
