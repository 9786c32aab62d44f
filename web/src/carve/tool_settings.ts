// SPDX-License-Identifier: Apache-2.0
// The user's choices, shown in the bar: the tool, how it follows the pointer, and its depth.

import { toolProfile } from '../model/tool_profile';
import type { ToolInfo, Welcome } from '../wire/types';
import { LEAN_MAX_RAD } from './aim';
import type { AimMode } from './aim';
import { DRAG_STRENGTHS } from './drag';
import type { DragStrength } from './drag';
import { recall, remember } from '../strings/memory';
import type { CarveBar } from './carve_bar';
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
  private tool_: ToolInfo | null = null;
  private depthMm_ = 1;

  constructor(
    private readonly hand: Hand,
    private readonly bar: Pick<
      CarveBar,
      'setTools' | 'setTool' | 'setMode' | 'setDrag' | 'setDepth'
    >,
    private readonly host: SettingsHost,
  ) {}

  get tool(): ToolInfo | null {
    return this.tool_;
  }

  get tools(): readonly ToolInfo[] {
    return this.welcome_?.tools ?? [];
  }

  get depthMm(): number {
    return this.depthMm_;
  }

  /** Fills the rack for a session that was joined, once. */
  prepare(welcome: Welcome): void {
    if (welcome === this.welcome_) return;
    this.welcome_ = welcome;
    const known = DRAG_STRENGTHS.find((one) => one === recall(DRAG));
    this.hand.drag.strength = known ?? DEFAULT_DRAG;
    this.bar.setDrag(this.hand.drag.strength);
    this.bar.setTools(welcome.tools);
    const tool = welcome.tools.find(({ id }) => id === this.tool_?.id) ?? welcome.tools[0];
    if (!tool) return;
    if (!this.tool_) this.depthMm_ = DEPTH_OF_RADIUS * toolProfile(tool).radiusMm;
    this.chooseTool(tool.id);
    this.showMode_();
  }

  chooseTool(id: number): void {
    const tool = this.tools.find((one) => one.id === id);
    if (!tool) return;
    this.host.changes();
    // The hello names the first one.
    if (this.tool_ && id !== this.tool_.id) this.hand.sampler.ask({ type: 'tool', tool: id });
    this.tool_ = tool;
    this.hand.takeTool(tool, this.host.color(), this.welcome_!);
    this.bar.setTool(id);
    this.setDepth(this.depthMm_);
  }

  /** Takes the next tool of the rack, or the one before. */
  nextTool(step: 1 | -1): void {
    const ids = this.tools.map(({ id }) => id);
    const at = ids.indexOf(this.tool_?.id ?? 0) + step;
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

  toggleLean(): void {
    const { settings } = this.hand;
    settings.leanMaxRad = settings.leanMaxRad > 0 ? 0 : LEAN_MAX_RAD;
    this.showMode_();
  }

  /** The next strength of the drag by the cutting force. */
  nextDrag(): void {
    const { drag } = this.hand;
    const at = DRAG_STRENGTHS.indexOf(drag.strength) + 1;
    drag.strength = DRAG_STRENGTHS[at % DRAG_STRENGTHS.length]!;
    remember(DRAG, drag.strength);
    this.bar.setDrag(drag.strength);
  }

  setDepth(mm: number): void {
    if (!this.tool_ || !this.welcome_) return;
    const { lengthMm, radiusMm } = toolProfile(this.tool_);
    const most = Math.min(lengthMm, DEEPEST_RADII * radiusMm);
    const least = Math.min(this.welcome_.pitch_mm, most / 2) / 2;
    this.depthMm_ = Math.min(most, Math.max(least, mm));
    this.hand.settings.depthMm = this.depthMm_;
    this.bar.setDepth(this.depthMm_, [least, most]);
    this.hand.hoverAgain(this.host.isJoined());
  }

  private showMode_(): void {
    const { mode, leanMaxRad } = this.hand.settings;
    this.bar.setMode(mode, leanMaxRad > 0);
    this.hand.hoverAgain(this.host.isJoined());
  }
}
