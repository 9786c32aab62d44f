// SPDX-License-Identifier: Apache-2.0
// The tools, arrows and names of all participants who carve, updated from the model once per frame.

import * as THREE from 'three';
import { ArrowScale } from '../model/arrow_scale';
import type { Participant } from '../model/participants';
import { emptyPose } from '../model/pose_track';
import type { Pose } from '../model/pose_track';
import { stockBounds } from '../model/session';
import type { SessionModel } from '../model/session';
import { Label } from './labels';
import { ReachView } from './reach_view';
import { ToolView } from './tool_view';
import { WrenchView } from './wrench_view';

// Delay with which tools are drawn, so that there is a later sample to interpolate towards.
const PLAYOUT_MS = 90;
const LABEL_HEIGHT = 1.25; // relative to the tool's height

interface Carver {
  tool: ToolView | null;
  toolId: number;
  color: string;
  wrench: WrenchView;
  /** Null: the device does not state where it reaches. */
  reachView: ReachView | null;
  label: Label;
  pose: Pose;
  hasPose: boolean;
  drawn: Pose;
}

/** A participant whose tool is drawn. */
export interface ShownCarver {
  id: number;
  name: string;
  color: string;
  tool: ToolView;
}

export class CarverViews {
  readonly scale = new ArrowScale();
  private readonly carvers_ = new Map<number, Carver>();
  private readonly labelPosition_ = new THREE.Vector3();
  private arrowsVisible_ = true;
  private pivotMm_ = 60;
  private arrowMm_ = 40;
  /** The participant whose tool is drawn elsewhere. */
  hidden: number | null = null;

  constructor(
    private readonly scene: THREE.Scene,
    private readonly overlay: HTMLElement,
    private readonly model: SessionModel,
  ) {}

  /** Removes all views, because a new session may define other tools. `arrowMm`: full length. */
  reset(pivotMm: number, arrowMm: number): void {
    for (const id of [...this.carvers_.keys()]) this.remove_(id);
    this.pivotMm_ = pivotMm;
    this.arrowMm_ = arrowMm;
  }

  get arrowsVisible(): boolean {
    return this.arrowsVisible_;
  }

  set arrowsVisible(visible: boolean) {
    this.arrowsVisible_ = visible;
    for (const carver of this.carvers_.values())
      carver.wrench.group.visible = visible && carver.hasPose;
  }

  /** Position of a participant's tip; null without a pose. Valid until the next update. */
  tipOf(participant: number): Pose['tip'] | null {
    const carver = this.carvers_.get(participant);
    return carver?.hasPose ? carver.pose.tip : null;
  }

  /** Those whose tools are drawn. */
  *shown(): Generator<ShownCarver> {
    for (const [id, { tool, color, hasPose }] of this.carvers_) {
      const participant = this.model.participants.get(id);
      if (tool && hasPose && participant) yield { id, name: participant.info.name, color, tool };
    }
  }

  /** Adds, moves and removes the views for a frame. Returns true if the picture changed. */
  update(nowMs: number): boolean {
    let changed = false;
    for (const id of [...this.carvers_.keys()]) {
      if (this.model.participants.get(id)) continue;
      this.remove_(id);
      changed = true;
    }
    const present = this.model.participants.carvers();
    this.scale.update(present, nowMs);
    for (const participant of present) {
      const carver = this.carver_(participant);
      if (this.move_(carver, participant, nowMs)) changed = true;
      if (this.showReach_(carver, participant)) changed = true;
    }
    return changed;
  }

  /** Places the names above the tools, after rendering has updated the world matrices. */
  placeLabels(camera: THREE.Camera, width: number, height: number, clearTop: number): void {
    for (const { tool, label, hasPose } of this.carvers_.values()) {
      if (!tool || !hasPose) continue;
      this.labelPosition_.set(0, 0, tool.topMm * LABEL_HEIGHT);
      this.labelPosition_.applyMatrix4(tool.group.matrixWorld);
      label.place(this.labelPosition_, camera, width, height, clearTop);
    }
  }

  private move_(carver: Carver, participant: Participant, nowMs: number): boolean {
    const { tool, wrench, pose, drawn, hasPose: had } = carver;
    const isShown = tool !== null && participant.info.participant !== this.hidden;
    carver.hasPose = isShown && participant.track.sample(nowMs - PLAYOUT_MS, pose);
    if (tool && had && !carver.hasPose) return this.hide_(carver, tool);
    if (!tool || !carver.hasPose || !differs(pose, drawn)) return false;
    copyPose(pose, drawn);
    tool.group.visible = true;
    tool.setPose(pose.tip, pose.axis);
    wrench.group.visible = this.arrowsVisible_;
    wrench.set(pose, this.pivotMm_, this.arrowMm_, this.scale.forceFullN, this.scale.torqueFullNmm);
    return true;
  }

  /** Draws the box in which the device reaches, while the tool is drawn. */
  private showReach_(carver: Carver, { info }: Participant): boolean {
    const { welcome } = this.model;
    let changed = false;
    if (welcome && carver.reachView?.reach !== info.reach) {
      carver.reachView?.dispose();
      carver.reachView = info.reach
        ? new ReachView(info.reach, carver.color, stockBounds(welcome.stock))
        : null;
      if (carver.reachView) this.scene.add(carver.reachView.outline);
      changed = true;
    }
    if (!carver.reachView) return changed;
    const shows = carver.hasPose && carver.reachView.leavesStockOut;
    if (carver.reachView.outline.visible === shows) return changed;
    carver.reachView.outline.visible = shows;
    return true;
  }

  /** Where a tool is in the past is known only while the block plays. */
  private hide_({ wrench, label, drawn }: Carver, tool: ToolView): true {
    tool.group.visible = false;
    wrench.group.visible = false;
    label.element.hidden = true;
    drawn.tip[0] = Number.NaN; // NaN differs from any pose: the next one is drawn
    return true;
  }

  private carver_(participant: Participant): Carver {
    const { participant: id, color, name } = participant.info;
    let carver = this.carvers_.get(id);
    if (!carver) {
      carver = {
        tool: null,
        toolId: 0,
        color,
        wrench: new WrenchView(),
        reachView: null,
        label: new Label(this.overlay),
        pose: emptyPose(),
        hasPose: false,
        drawn: emptyPose(),
      };
      carver.label.element.hidden = true;
      this.scene.add(carver.wrench.group);
      this.carvers_.set(id, carver);
    }
    if (carver.toolId !== participant.tool || carver.color !== color) {
      this.replaceTool_(carver, participant.tool, color);
    }
    carver.label.set(name, color);
    return carver;
  }

  private replaceTool_(carver: Carver, toolId: number, color: string): void {
    carver.tool?.dispose();
    const info = this.model.tool(toolId);
    carver.tool = info ? new ToolView(info, color, this.pivotMm_) : null;
    carver.toolId = toolId;
    carver.color = color;
    carver.drawn.tip[0] = Number.NaN; // NaN differs from any pose: the next one is drawn
    if (!carver.tool) return;
    carver.tool.group.visible = false; // until there is a pose
    this.scene.add(carver.tool.group);
  }

  private remove_(id: number): void {
    const carver = this.carvers_.get(id);
    if (!carver) return;
    carver.tool?.dispose();
    carver.wrench.dispose();
    carver.reachView?.dispose();
    carver.label.dispose();
    this.carvers_.delete(id);
  }
}

function differs(a: Pose, b: Pose): boolean {
  for (let i = 0; i < 3; ++i) {
    if (
      a.tip[i] !== b.tip[i] ||
      a.axis[i] !== b.axis[i] ||
      a.force[i] !== b.force[i] ||
      a.torque[i] !== b.torque[i]
    )
      return true;
  }
  return false;
}

function copyPose(from: Pose, to: Pose): void {
  for (let i = 0; i < 3; ++i) {
    to.tip[i] = from.tip[i]!;
    to.axis[i] = from.axis[i]!;
    to.force[i] = from.force[i]!;
    to.torque[i] = from.torque[i]!;
  }
  to.removedRate = from.removedRate;
}
