// SPDX-License-Identifier: Apache-2.0
// The session in a headset: draws its frames, and lets the hands hold the block and the tool.

import { t } from '../../strings';
import { stockBounds } from '../../model/session';
import type { SessionModel } from '../../model/session';
import { toolName } from '../../model/tool_profile';
import { ToolView } from '../../view/tool_view';
import type { Viewer } from '../../view/viewer';
import type { Wielded } from '../tool/wielded';
import { Controllers, HANDS } from './controllers';
import type { Controller, Hand } from './controllers';
import { FrameMeter } from './frame_meter';
import type { FrameCost } from './frame_meter';
import { HandView } from './hand_view';
import { Headset } from './headset';
import { Others } from './others';
import { Placement } from './placement';
import { Pulses } from './pulses';
import { aheadM, cutsNow, toolPose } from './tool_grip';
import type { TriggerMode } from './tool_grip';
import { WristPanel } from './wrist_panel';
import type { PanelAction } from './wrist_panel';

const NOTE_MS = 4000;

export interface VrHost {
  model: SessionModel;
  viewer: Viewer;
  /** Null: this viewer may only look. */
  wielded: Wielded | null;
  color: string;
  /** Does the page's work of one frame: a headset may stop the page's own frames. */
  frame: (nowMs: number) => void;
  ended: () => void;
}

/** For tests. */
export interface VrState extends FrameCost {
  pulses: number;
  others: number;
  scale: number;
  pointed: PanelAction | null;
  trigger: TriggerMode;
  note: string;
}

export class VrMode {
  private readonly placement_ = new Placement();
  private readonly controllers_ = new Controllers();
  private readonly panel_ = new WristPanel();
  private readonly pulses_ = new Pulses();
  private readonly meter_ = new FrameMeter();
  private readonly others_: Others;
  private readonly headset_: Headset;
  private readonly hands_: Record<Hand, HandView>;
  private toolHand_: Hand = 'right';
  private trigger_: TriggerMode = 'cuts';
  private pointed_: PanelAction | null = null;
  /** The trigger has pressed a button, and cuts again when it is let go. */
  private isPressing_ = false;
  private cuts_ = false;
  private note_ = '';
  private noteUntilMs_ = 0;

  constructor(
    private readonly session: XRSession,
    private readonly host: VrHost,
  ) {
    const { viewer, color } = host;
    this.others_ = new Others(viewer.carvers);
    this.headset_ = new Headset(viewer);
    this.hands_ = { left: new HandView(color), right: new HandView(color) };
    const { physical } = this.headset_;
    physical.add(this.panel_.mesh, ...HANDS.map((hand) => this.hands_[hand].group));
    this.panel_.place(null);
  }

  /** Shows the block in the headset; resolves when the session has begun. */
  async begin(): Promise<void> {
    this.placement_.stand(stockBounds(this.host.model.welcome!.stock));
    this.session.addEventListener('end', () => this.end_());
    await this.headset_.begin(this.session, (nowMs, frame) => this.frame_(nowMs, frame));
  }

  get state(): VrState {
    return {
      ...this.meter_.cost,
      pulses: this.pulses_.count,
      others: this.others_.count,
      scale: this.placement_.scale,
      pointed: this.pointed_,
      trigger: this.trigger_,
      note: this.note_,
    };
  }

  private frame_(nowMs: number, frame: XRFrame): void {
    const startMs = performance.now();
    const space = this.headset_.space;
    const found = space
      ? this.controllers_.read(this.session.inputSources, (of) => frame.getPose(of, space))
      : new Map<Hand, Controller>();
    this.host.frame(nowMs);
    this.hold_(found);
    for (const hand of HANDS) this.showHand_(hand, found.get(hand));
    this.wield_(found, nowMs);
    this.others_.update(this.placement_, this.headset_.eye);
    const { calls, triangles } = this.headset_.draw(this.placement_.toPhysical, nowMs);
    this.meter_.add(performance.now() - startMs, calls, triangles);
  }

  private hold_(found: Map<Hand, Controller>): void {
    const grips = HANDS.map((hand) => found.get(hand));
    this.placement_.hold(grips.map((one) => (one?.isSqueezed ? one.grip : null)));
  }

  private showHand_(hand: Hand, controller: Controller | undefined): void {
    const { group } = this.hands_[hand];
    group.visible = controller !== undefined;
    if (!controller) return;
    group.position.copy(controller.grip.position);
    group.quaternion.copy(controller.grip.quaternion);
  }

  private wield_(found: Map<Hand, Controller>, nowMs: number): void {
    const tool = found.get(this.toolHand_);
    const other = found.get(this.toolHand_ === 'right' ? 'left' : 'right');
    this.panel_.place(other?.grip ?? null);
    this.pointed_ = this.panel_.pointAt(tool?.grip ?? null);
    const { wielded } = this.host;
    if (tool && this.pointed_ && tool.pulled) {
      this.isPressing_ = true;
      this.press_(this.pointed_);
    }
    if (!tool?.isPulled) this.isPressing_ = false;
    if (wielded && tool) this.carve_(wielded, tool, nowMs);
    else if (this.cuts_) this.lift_();
    this.drawPanel_(nowMs);
  }

  private carve_(wielded: Wielded, tool: Controller, nowMs: number): void {
    if (tool.step !== 0) wielded.settings.nextTool(tool.step);
    if (tool.lower) wielded.undo();
    if (tool.upper) wielded.redo();
    const info = wielded.settings.tool;
    if (!info) return;
    const { scale, toPhysical } = this.placement_;
    const topMm = ToolView.topMm(info, this.host.model.welcome!.pivot_mm);
    const isFree = !tool.isSqueezed && !this.pointed_ && !this.isPressing_;
    const wishes = isFree && cutsNow(this.trigger_, tool.isPulled);
    const reason = wishes ? wielded.whyNot() : '';
    if (reason !== '') this.say_(reason, nowMs);
    const cuts = wishes && reason === '';
    if (this.cuts_ && !cuts) wielded.lift();
    this.cuts_ = cuts;
    wielded.moveTo(toolPose(tool.grip, aheadM(topMm, scale), toPhysical), cuts);
    const share = wielded.forceN() / Math.max(0.1, this.host.viewer.arrowScale.forceFullN);
    this.pulses_.feel(tool.source.gamepad, share, nowMs);
  }

  private press_(action: PanelAction): void {
    const { wielded } = this.host;
    switch (action) {
      case 'undo':
        wielded?.undo();
        return;
      case 'redo':
        wielded?.redo();
        return;
      case 'before':
        wielded?.settings.nextTool(-1);
        return;
      case 'next':
        wielded?.settings.nextTool(1);
        return;
      case 'trigger':
        this.trigger_ = this.trigger_ === 'cuts' ? 'lifts' : 'cuts';
        return;
      case 'hand':
        this.lift_();
        this.toolHand_ = this.toolHand_ === 'right' ? 'left' : 'right';
        return;
      case 'leave':
        void this.session.end();
    }
  }

  private lift_(): void {
    this.cuts_ = false;
    this.host.wielded?.lift();
  }

  private say_(text: string, nowMs: number): void {
    this.note_ = text;
    this.noteUntilMs_ = nowMs + NOTE_MS;
  }

  private drawPanel_(nowMs: number): void {
    const { wielded, viewer } = this.host;
    if (nowMs > this.noteUntilMs_) this.note_ = wielded ? '' : t('You can watch, but not carve.');
    this.panel_.draw({
      tool: toolName(wielded?.settings.tool ?? undefined),
      forceN: wielded?.forceN() ?? 0,
      fullN: viewer.arrowScale.forceFullN,
      trigger: this.trigger_,
      note: this.note_,
    });
  }

  private end_(): void {
    this.lift_();
    this.headset_.end();
    this.others_.dispose();
    this.panel_.dispose();
    for (const hand of HANDS) this.hands_[hand].dispose();
    this.host.ended();
  }
}
