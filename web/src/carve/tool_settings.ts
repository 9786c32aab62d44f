// SPDX-License-Identifier: Apache-2.0
// The user's choices, shown in the bar: the tool, how it follows the pointer, and its depth.

import { signal, untracked } from '@preact/signals';
import { toolProfile } from '../model/tool_profile';
import {
  clampedMm,
  diameterOf,
  nextDiameter,
  sameTool,
  withDiameter,
  withShape,
} from '../model/tool_sizes';
import type { NewTool, PaletteShape } from '../model/tool_sizes';
import type { ToolInfo, Welcome } from '../wire/types';
import { AXIS_CHOICES } from './aim';
import type { AimMode, AxisChoice } from './aim';
import { DRAG_STRENGTHS } from './drag';
import type { DragStrength } from './drag';
import { t } from '../strings';
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
  /** The tools of the session, as a signal's value. */
  tools: () => readonly ToolInfo[];
  /** Whether the role of this viewer allows it to make tools, as a signal's value. */
  mayMake: () => boolean;
  /** Makes a tool of the session; rejects with a sentence that says why not. */
  makeTool: (tool: NewTool) => Promise<ToolInfo>;
  /** Tells the user why something is not done. */
  say: (text: string) => void;
}

export class ToolSettings {
  private welcome_: Welcome | null = null; // for which the rack was filled
  readonly mode = signal<AimMode>('surface');
  readonly axis = signal<AxisChoice>('surface');
  readonly drag = signal<DragStrength>(DEFAULT_DRAG);
  /** The depth and its bounds, mm. */
  readonly depth = signal({ mm: 1, least: 0.1, most: 10 });
  private readonly tool_ = signal<ToolInfo | null>(null);
  /** The tool that is asked for while the session makes it, or that comes after it. */
  private readonly wish_ = signal<NewTool | null>(null);
  private isMaking_ = false;

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
    return this.host.tools();
  }

  /** The tool in the hand, or the one that it gets next; as a signal's value. */
  get wish(): NewTool | null {
    return this.wish_.value ?? this.tool_.value;
  }

  get mayMake(): boolean {
    return this.host.mayMake();
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
    const tools = this.peekTools_();
    const before = this.tool_.peek();
    const tool = tools.find(({ id }) => id === before?.id) ?? tools[0];
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
    const tool = this.peekTools_().find((one) => one.id === id);
    if (!tool) return;
    this.wish_.value = null;
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
    const ids = this.peekTools_().map(({ id }) => id);
    const at = ids.indexOf(this.tool_.peek()?.id ?? 0) + step;
    const id = ids[(at + ids.length) % ids.length];
    if (id !== undefined) this.chooseTool(id);
  }

  /** Takes the tool of this shape with the next larger diameter, or the next smaller one. */
  resize(direction: 1 | -1): void {
    const mm = this.diameterNow_();
    if (mm !== null) this.setDiameter(nextDiameter(mm, direction));
  }

  /** Takes the tool of this shape with a diameter, mm, which the session has or makes. */
  setDiameter(mm: number): void {
    const now = this.now_();
    const tool = now && withDiameter(now, clampedMm(mm));
    if (tool) this.take_(tool);
  }

  /** Takes a tool of the palette as wide as the one now. */
  chooseShape(shape: PaletteShape): void {
    const now = this.now_();
    if (now) this.take_(withShape(now, shape, diameterOf(now) ?? this.widthNow_(now)));
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

  /** Reads signals without being called again when they change. */
  private peekTools_(): readonly ToolInfo[] {
    return untracked(() => this.host.tools());
  }

  private now_(): ToolInfo | null {
    const tool = this.tool_.peek();
    const wish = this.wish_.peek();
    return tool && wish ? { ...wish, id: tool.id } : tool;
  }

  /** Says so where the tool has no diameter that could change. */
  private diameterNow_(): number | null {
    const now = this.now_();
    const mm = now && diameterOf(now);
    if (now && mm === null)
      this.host.say(t('This tool has one size only. Choose a shape to change it.'));
    return mm;
  }

  private widthNow_(tool: ToolInfo): number {
    return clampedMm(2 * toolProfile(tool).radiusMm);
  }

  private take_(tool: NewTool): void {
    const there = sameTool(this.peekTools_(), tool);
    if (there && !this.isMaking_) {
      this.chooseTool(there.id);
      return;
    }
    this.wish_.value = tool;
    if (!this.isMaking_) void this.make_();
  }

  /** Makes the tool that is asked for; if it is another one by then, that one too. */
  private async make_(): Promise<void> {
    this.isMaking_ = true;
    try {
      for (let wish = this.wish_.peek(); wish; wish = this.wish_.peek()) {
        const there = sameTool(this.peekTools_(), wish);
        const made = there ?? (await this.host.makeTool(wish));
        if (this.wish_.peek() === wish) this.chooseTool(made.id);
      }
    } catch (problem) {
      this.wish_.value = null;
      this.host.say((problem as Error).message);
    } finally {
      this.isMaking_ = false;
    }
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
