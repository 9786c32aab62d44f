// SPDX-License-Identifier: Apache-2.0
// Draws the session: owns the views, updates them from the model once per displayed frame, and
// draws only after a change.

import * as THREE from 'three';
import type { StockMaterialPreset } from '../model/materials';
import { errorRad } from '../model/look_policy';
import { roundUp125 } from '../model/forces';
import type { Participant } from '../model/participants';
import { emptyPose } from '../model/pose_track';
import type { Pose } from '../model/pose_track';
import { Quality } from '../model/quality';
import { stockBounds } from '../model/session';
import type { Bounds, SessionModel } from '../model/session';
import { toolProfile } from '../model/tool_profile';
import { MESH_SNAPSHOT_LAST } from '../wire/types';
import type { Header, Look, Welcome } from '../wire/types';
import { CameraRig } from './camera_rig';
import type { Insets } from './camera_rig';
import { TileParser } from './glb_tiles';
import { Label } from './labels';
import { Stage } from './stage';
import { StockMaterial } from './stock_material';
import { TileView } from './tile_view';
import { ToolView } from './tool_view';
import { WrenchView } from './wrench_view';

// Delay with which tools are drawn, so that there is a later sample to interpolate towards.
const PLAYOUT_MS = 90;
const STILL_AFTER_MS = 260;
const PHONE_WIDTH_PX = 760; // as in ui/style/phone.css
const ARROW_FRACTION = 0.34; // length of a full-scale arrow relative to the block's diagonal
const RESCALE_EVERY_MS = 250;
const FULL_PER_TYPICAL = 2;
const LEAST_FULL_N = 0.1; // smaller scales would display noise
const LEAST_FULL_NMM = 1;

interface Carver {
  tool: ToolView | null;
  toolId: number;
  color: string;
  wrench: WrenchView;
  label: Label;
  pose: Pose;
  drawn: Pose;
}

export class Viewer {
  readonly rig: CameraRig;
  readonly stage: Stage;
  /** The force and torque of a full-length arrow. */
  forceFullN = 1;
  torqueFullNmm = 1;
  private arrowsVisible_ = true;
  private readonly stockMaterial_ = new StockMaterial();
  private readonly tiles_ = new TileView(this.stockMaterial_.material);
  private readonly parser_ = new TileParser();
  private readonly carvers_ = new Map<number, Carver>();
  private readonly quality_: Quality;
  private readonly top_ = new THREE.Vector3();
  private width_ = 1;
  private height_ = 1;
  private clearTop_ = 0;
  private pivotMm_ = 60;
  private arrowMm_ = 40;
  private dirty_ = true;
  private shadowsDirty_ = true;
  private stillDrawn_ = false;
  private lastDrawMs_ = 0;
  private lastTickMs_ = 0;
  private rescaledMs_ = -Infinity;
  private followed_: number | null = null;
  private fitted_ = false;

  /** @param fixedQuality draw every frame at full quality, regardless of speed */
  constructor(
    canvas: HTMLCanvasElement,
    private readonly overlay: HTMLElement,
    private readonly model: SessionModel,
    private readonly fixedQuality: boolean,
  ) {
    this.stage = new Stage(canvas);
    this.quality_ = new Quality(
      Math.min(2, window.devicePixelRatio || 1),
      !fixedQuality && this.stage.drawsInSoftware,
    );
    this.stage.scene.add(this.tiles_.group);
    this.rig = new CameraRig(canvas, window.matchMedia('(prefers-reduced-motion: reduce)').matches);
  }

  /** Prepares the views for a session that was joined or joined again. */
  welcome(welcome: Welcome): void {
    const bounds = stockBounds(welcome.stock);
    this.stage.setBounds(bounds, welcome.pitch_mm);
    this.rig.setBounds(withSpaceForTools(bounds, welcome));
    this.stockMaterial_.setStock(
      welcome.stock,
      welcome.pitch_mm,
      new THREE.Vector3(...bounds.min),
      new THREE.Vector3(...bounds.max),
    );
    this.pivotMm_ = welcome.pivot_mm;
    this.arrowMm_ =
      ARROW_FRACTION *
      new THREE.Vector3(...bounds.min).distanceTo(new THREE.Vector3(...bounds.max));
    // Their tools may have been redefined.
    for (const id of [...this.carvers_.keys()]) this.removeCarver_(id);
    if (!this.fitted_) this.rig.preset('iso', performance.now());
    this.fitted_ = true;
    this.touch();
  }

  /** Displays those tiles of a mesh frame that are not older than the displayed ones. */
  async applyMesh(header: Header, glb: Uint8Array): Promise<void> {
    const { generation } = this.model.tiles;
    const tiles = await this.parser_.parse(glb);
    // Reconnected meanwhile: a new snapshot follows.
    if (generation !== this.model.tiles.generation) return;
    for (const tile of tiles) {
      if (this.model.tiles.offer(tile.x, tile.y, tile.version, tile.triangles, tile.level))
        this.tiles_.set(tile);
      else tile.geometry?.dispose();
    }
    if (header.flags & MESH_SNAPSHOT_LAST) {
      for (const key of this.model.tiles.finishSnapshot()) this.tiles_.remove(key);
    }
    this.shadowsDirty_ = true;
    this.touch();
  }

  /**
   * Returns the camera position with the acceptable error, and the camera's distance to its target.
   */
  look(): { look: Look; distanceMm: number } {
    const { camera, controls } = this.rig;
    const weak = this.width_ <= PHONE_WIDTH_PX || this.stage.drawsInSoftware;
    const error_rad = this.fixedQuality ? 0 : errorRad(camera.fov, this.height_, weak);
    return {
      look: { eye_mm: camera.position.toArray(), error_rad },
      distanceMm: camera.position.distanceTo(controls.target),
    };
  }

  setMaterial(preset: StockMaterialPreset): void {
    this.stockMaterial_.setPreset(preset);
    this.touch();
  }

  get arrowsVisible(): boolean {
    return this.arrowsVisible_;
  }

  set arrowsVisible(visible: boolean) {
    this.arrowsVisible_ = visible;
    for (const carver of this.carvers_.values()) carver.wrench.group.visible = visible;
    this.touch();
  }

  /** Requests a redraw. */
  touch(): void {
    this.dirty_ = true;
  }

  follow(participant: number | null): void {
    this.followed_ = participant;
    if (participant === null) this.rig.followPoint(null);
  }

  get followed(): number | null {
    return this.followed_;
  }

  resize(width: number, height: number, insets: Insets): void {
    this.width_ = width;
    this.height_ = height;
    this.clearTop_ = insets.top;
    this.stage.setSize(width, height, this.quality_.movingRatio);
    this.rig.resize(width, height, insets);
    this.touch();
  }

  /** Centers the picture on the point of the block under a canvas position (CSS pixels). */
  lookAtPixel(x: number, y: number): void {
    const pointer = new THREE.Vector2((x / this.width_) * 2 - 1, 1 - (y / this.height_) * 2);
    const raycaster = new THREE.Raycaster();
    raycaster.setFromCamera(pointer, this.rig.camera);
    const point = this.tiles_.pick(raycaster);
    if (point) this.rig.lookAt(point, performance.now());
  }

  /** Updates and draws one displayed frame. */
  tick(nowMs: number): void {
    const since = Math.min(100, nowMs - this.lastTickMs_);
    this.lastTickMs_ = nowMs;
    this.moveTools_(nowMs);
    if (this.rig.update(nowMs, since)) this.touch();
    if (this.dirty_) {
      if (nowMs - this.lastDrawMs_ >= this.quality_.pauseMs) this.drawMoving_(nowMs);
    } else if (!this.stillDrawn_ && nowMs - this.lastDrawMs_ > STILL_AFTER_MS) this.drawStill_();
  }

  private drawMoving_(nowMs: number): void {
    const moving = !this.stillDrawn_;
    if (moving && !this.fixedQuality) this.quality_.frame(nowMs - this.lastDrawMs_);
    this.stage.setSize(this.width_, this.height_, this.quality_.movingRatio);
    this.draw_(this.shadowsDirty_ && this.quality_.shadowsWhileMoving);
    this.dirty_ = false;
    this.stillDrawn_ = false;
    this.lastDrawMs_ = nowMs;
  }

  private drawStill_(): void {
    this.stage.setSize(this.width_, this.height_, this.quality_.stillRatio);
    this.draw_(this.shadowsDirty_);
    this.stillDrawn_ = true;
    this.quality_.rested();
  }

  private draw_(withShadows: boolean): void {
    if (withShadows) this.shadowsDirty_ = false;
    this.stage.render(this.rig.camera, withShadows);
    for (const carver of this.carvers_.values()) {
      if (!carver.tool) continue;
      this.top_.set(0, 0, carver.tool.topMm * 1.25).applyMatrix4(carver.tool.group.matrixWorld);
      carver.label.place(this.top_, this.rig.camera, this.width_, this.height_, this.clearTop_);
    }
  }

  private moveTools_(nowMs: number): void {
    const present = this.model.participants.carvers();
    for (const id of [...this.carvers_.keys()]) {
      if (!this.model.participants.get(id)) this.removeCarver_(id);
    }
    this.rescaleArrows_(present, nowMs);
    for (const participant of present) {
      const carver = this.carver_(participant);
      if (!carver.tool || !participant.track.sample(nowMs - PLAYOUT_MS, carver.pose)) continue;
      if (participant.info.participant === this.followed_) this.rig.followPoint(carver.pose.tip);
      if (!differs(carver.pose, carver.drawn)) continue;
      copyPose(carver.pose, carver.drawn);
      carver.tool.group.visible = true;
      carver.tool.setPose(carver.pose.tip, carver.pose.axis);
      carver.wrench.group.visible = this.arrowsVisible_;
      carver.wrench.set(
        carver.pose,
        this.pivotMm_,
        this.arrowMm_,
        this.forceFullN,
        this.torqueFullNmm,
      );
      this.shadowsDirty_ = true;
      this.touch();
    }
  }

  /**
   * Chooses one scale for all arrows, so that they can be compared. The scale follows the RMS, not
   * the maximum: a single peak must not shrink all arrows for ten seconds.
   */
  private rescaleArrows_(present: readonly Participant[], nowMs: number): void {
    if (nowMs - this.rescaledMs_ < RESCALE_EVERY_MS) return;
    this.rescaledMs_ = nowMs;
    let forceN = LEAST_FULL_N;
    let torqueNmm = LEAST_FULL_NMM;
    for (const { forces } of present) {
      const { typical } = forces;
      forceN = Math.max(forceN, FULL_PER_TYPICAL * typical.forceN);
      torqueNmm = Math.max(torqueNmm, FULL_PER_TYPICAL * typical.torqueNmm);
    }
    this.forceFullN = roundUp125(forceN);
    this.torqueFullNmm = roundUp125(torqueNmm);
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
        label: new Label(this.overlay),
        pose: emptyPose(),
        drawn: emptyPose(),
      };
      carver.label.element.hidden = true;
      this.stage.scene.add(carver.wrench.group);
      this.carvers_.set(id, carver);
    }
    if (carver.toolId !== participant.tool || carver.color !== color)
      this.replaceTool_(carver, participant.tool, color);
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
    this.stage.scene.add(carver.tool.group);
  }

  private removeCarver_(id: number): void {
    const carver = this.carvers_.get(id);
    if (!carver) return;
    carver.tool?.dispose();
    carver.wrench.dispose();
    carver.label.dispose();
    this.carvers_.delete(id);
    this.shadowsDirty_ = true;
    this.touch();
  }
}

/**
 * Returns the box that a full view shows: the block, extended upward by part of the longest tool.
 */
function withSpaceForTools({ min, max }: Bounds, { tools }: Welcome): Bounds {
  const longest = Math.max(0, ...tools.map((tool) => toolProfile(tool).lengthMm));
  const diagonal = Math.hypot(max[0] - min[0], max[1] - min[1], max[2] - min[2]);
  return { min, max: [max[0], max[1], max[2] + Math.min(0.6 * longest, 0.16 * diagonal)] };
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
