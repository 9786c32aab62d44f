// SPDX-License-Identifier: Apache-2.0
// Draws the session: owns the views, updates them from the model once per displayed frame, and
// draws only after a change.

import * as THREE from 'three';
import type { MeshFrame } from '../decode/mesh_glb';
import type { StockMaterialPreset } from '../model/materials';
import type { ArrowScale } from '../model/arrow_scale';
import { viewBounds } from '../model/first_look';
import type { PlacedLook } from '../model/first_look';
import type { Viewport } from '../model/fit';
import { drawnRatio, Quality } from '../model/quality';
import { stockBounds } from '../model/session';
import type { SessionModel } from '../model/session';
import type { TileTriangles } from '../kernel/kernel';
import { mark } from '../model/marks';
import { MESH_SNAPSHOT_LAST } from '../wire/types';
import type { Header, Vec3, Welcome } from '../wire/types';
import { CameraRig } from './camera_rig';
import { CarverViews } from './carver_views';
import { DisplayedSurface } from './displayed_surface';
import { tilesOf } from './parsed_tiles';
import type { ParsedTile } from './parsed_tiles';
import { LocalTiles } from './local_tiles';
import { Readback } from './readback';
import { carverSample } from './shader_samples';
import { drawsInSoftware, Stage } from './stage';
import { StockMaterial } from './stock_material';
import { TileView } from './tile_view';

const ARROW_FRACTION = 0.34; // length of a full-scale arrow relative to the block's diagonal

/** Something drawn with the block. */
export interface Layer {
  /** Draws over the picture. */
  draw?: (renderer: THREE.WebGLRenderer, camera: THREE.Camera) => void;
  /** A picture was drawn: elements that it lacks can be put in position. */
  drawn?: (camera: THREE.Camera, width: number, height: number) => void;
}

export class Viewer {
  readonly layers = new Set<Layer>();
  /** Nothing is drawn but by drawLarge(). */
  isRecording = false;
  readonly rig: CameraRig;
  readonly stage: Stage;
  readonly stockMaterial = new StockMaterial();
  readonly tiles = new TileView(this.stockMaterial.material);
  /** Where the page's copy of the block is ahead of the server's meshes. */
  readonly local = new LocalTiles(this.tiles);
  /** The triangles of the tiles, for rays. */
  readonly displayed = new DisplayedSurface(this.tiles);
  readonly carvers: CarverViews;
  private readonly quality_: Quality;
  private width_ = 1;
  private height_ = 1;
  private clearTop_ = 0;
  private dirty_ = true;
  private shadowsDirty_ = true;
  private stillDrawn_ = false;
  private lastDrawMs_ = 0;
  private lastTickMs_ = 0;
  private followed_: number | null = null;
  private fitted_ = false;
  private compiled_: Promise<void> | null = null;
  private canDraw_ = false;
  private begun_ = 0;
  private shown_ = 0;
  private readonly readback_: Readback | null; // null: the page shows the canvas that is drawn on
  /** Where a headset looks from, which draws instead of the page; null: none. */
  eyeElsewhere: THREE.Vector3 | null = null;

  /** @param fixedQuality draw every frame at full quality, regardless of speed */
  constructor(
    canvas: HTMLCanvasElement,
    overlay: HTMLElement,
    private readonly model: SessionModel,
    private readonly fixedQuality: boolean,
  ) {
    const weak = drawsInSoftware();
    const isReadBack = weak && !fixedQuality;
    const drawn = isReadBack ? document.createElement('canvas') : canvas;
    this.stage = new Stage(drawn, weak, !isReadBack);
    this.readback_ = isReadBack ? new Readback(this.stage.gl, canvas) : null;
    this.quality_ = new Quality(drawnRatio(window.devicePixelRatio), weak && !fixedQuality);
    this.stage.scene.add(this.tiles.group);
    this.carvers = new CarverViews(this.stage.scene, overlay, model);
    this.rig = new CameraRig(canvas, window.matchMedia('(prefers-reduced-motion: reduce)').matches);
  }

  /** Prepares the views for a session that was joined or joined again. */
  welcome(welcome: Welcome): void {
    const bounds = stockBounds(welcome.stock);
    this.stage.setBounds(bounds, welcome.pitch_mm);
    this.rig.setBounds(viewBounds(welcome));
    this.stockMaterial.setBounds(
      welcome.pitch_mm,
      new THREE.Vector3(...bounds.min),
      new THREE.Vector3(...bounds.max),
    );
    const diagonalMm = new THREE.Vector3(...bounds.min).distanceTo(
      new THREE.Vector3(...bounds.max),
    );
    this.carvers.reset(welcome.pivot_mm, ARROW_FRACTION * diagonalMm);
    this.local.clear();
    this.shadowsDirty_ = true;
    if (!this.fitted_) this.rig.preset('iso', performance.now());
    this.fitted_ = true;
    this.compiled_ ??= this.compile_();
    this.touch();
  }

  /** Displays those tiles of a mesh frame that are not older than the displayed ones. */
  applyMesh(header: Header, frame: MeshFrame): void {
    for (const tile of tilesOf(frame)) this.offer_(tile);
    if (header.flags & MESH_SNAPSHOT_LAST) {
      for (const key of this.model.tiles.finishSnapshot()) this.local.remove(key);
    }
    this.shadowsDirty_ = true;
    this.touch();
  }

  private offer_(tile: ParsedTile): void {
    const { grid, pitch_mm } = this.model.welcome!;
    for (let y = tile.y; y < tile.y + tile.rows; ++y) {
      for (let x = tile.x; x < tile.x + tile.columns; ++x) {
        const { version, triangles, level, digest } = tile;
        if (this.model.tiles.offer(x, y, version, triangles, level, digest))
          this.local.set(tile, x, y, grid.tile * pitch_mm);
      }
    }
  }

  /** Displays tiles of the page's copy, which has its samples up to `newest`. */
  applyCopy(tiles: readonly TileTriangles[], newest: bigint): void {
    const { state, welcome } = this.model;
    if (!welcome || state?.at) return; // the past is the server's
    this.local.cover(tiles, newest, welcome.grid.origin_mm);
    this.touchAll();
  }

  /** Whether the picture moves smoothly. */
  get isFast(): boolean {
    return !this.stage.drawsInSoftware && !this.quality_.isSlow;
  }

  /** Returns the camera position, with the acceptable error. */
  look(error_rad: number): PlacedLook {
    const { camera, controls } = this.rig;
    const eye = this.eyeElsewhere ?? camera.position;
    return {
      look: { eye_mm: eye.toArray(), error_rad },
      distanceMm: eye.distanceTo(controls.target),
    };
  }

  setMaterial(preset: StockMaterialPreset): void {
    this.stockMaterial.setPreset(preset);
    this.touch();
  }

  /** Where the block is in the picture, CSS pixels: left, top, right, bottom. */
  get blockBox(): [number, number, number, number] | null {
    const { welcome } = this.model;
    if (!welcome) return null;
    const { min, max } = stockBounds(welcome.stock);
    const x: number[] = [];
    const y: number[] = [];
    for (let corner = 0; corner < 8; ++corner) {
      const at = (n: 0 | 1 | 2): number => ((corner >> n) & 1 ? max[n] : min[n]);
      const [right, down] = this.seen_(new THREE.Vector3(at(0), at(1), at(2)));
      x.push(right);
      y.push(down);
    }
    return [Math.min(...x), Math.min(...y), Math.max(...x), Math.max(...y)];
  }

  /** Position of the camera's target, CSS pixels: the middle of the area without panels. */
  get middle(): [x: number, y: number] {
    return this.seen_(this.rig.controls.target.clone());
  }

  private seen_(point: THREE.Vector3): [x: number, y: number] {
    const { x, y } = point.project(this.rig.eye);
    return [((1 + x) / 2) * this.width_, ((1 - y) / 2) * this.height_];
  }

  /** The corners of all triangles that are displayed, nine numbers each, mm. */
  surface(): number[] {
    return this.tiles.corners();
  }

  /** Pictures that were begun, and shown; `isLast`: with all there is; `isStill`: at full quality. */
  get pictures(): { begun: number; shown: number; isLast: boolean; isStill: boolean } {
    const isLast = !this.dirty_ && this.begun_ === this.shown_;
    const isStill = isLast && (this.stillDrawn_ || this.fixedQuality);
    return { begun: this.begun_, shown: this.shown_, isLast, isStill };
  }

  /** Calls of the last picture, those of its shadows included if they changed. */
  get drawCalls(): number {
    return this.stage.renderer.info.render.calls;
  }

  get arrowScale(): ArrowScale {
    return this.carvers.scale;
  }

  set arrowsVisible(visible: boolean) {
    this.carvers.arrowsVisible = visible;
    this.touch();
  }

  toggleGrid(): void {
    this.stage.gridVisible = !this.stage.gridVisible;
    this.touch();
  }

  /** Draws in parallel projection instead of perspective. */
  set parallel(parallel: boolean) {
    this.rig.parallel = parallel;
    this.touch();
  }

  /** Requests a redraw, also of the shadows. */
  touchAll(): void {
    this.shadowsDirty_ = true;
    this.touch();
  }

  /** Whether the shadows have changed since they were drawn; they are drawn now. */
  takeShadows(): boolean {
    const changed = this.shadowsDirty_;
    this.shadowsDirty_ = false;
    return changed;
  }

  /** Requests a redraw. */
  touch(): void {
    this.dirty_ = true;
  }

  /** A participant whose tool is drawn elsewhere; null: none. */
  set hiddenCarver(participant: number | null) {
    this.carvers.hidden = participant;
    this.touch();
  }

  follow(participant: number | null): void {
    this.followed_ = participant;
    if (participant === null) this.rig.followPoint(null);
  }

  /**
   * Draws the picture with so many pixels on its longer side, centered, and returns the canvas. It
   * has to be read at once: the next frame has the old size.
   * @param withShadows draw those again that have not changed
   */
  drawLarge(pixels: number, withShadows = true): HTMLCanvasElement {
    this.stage.setSize(this.width_, this.height_, pixels / Math.max(this.width_, this.height_));
    this.rig.centered(() => this.draw_(withShadows || this.shadowsDirty_));
    this.touch();
    return this.stage.renderer.domElement;
  }

  resize({ width, height, insets }: Viewport): void {
    this.width_ = width;
    this.height_ = height;
    this.clearTop_ = insets.top;
    this.stage.setSize(width, height, this.quality_.movingRatio);
    this.rig.resize(width, height, insets);
    this.touch();
  }

  /** The line of sight through a canvas position (CSS pixels), from its nearest visible point. */
  ray(x: number, y: number): THREE.Ray {
    const [right, up] = [(x / this.width_) * 2 - 1, 1 - (y / this.height_) * 2];
    const near = new THREE.Vector3(right, up, -1).unproject(this.rig.eye);
    const far = new THREE.Vector3(right, up, 1).unproject(this.rig.eye);
    return new THREE.Ray(near, far.sub(near).normalize());
  }

  /** The unit vector that leans by these parts to the right of the picture and towards the viewer. */
  upright(right: number, towards: number): THREE.Vector3 {
    const up = new THREE.Vector3(
      0,
      0,
      Math.sqrt(Math.max(0, 1 - right * right - towards * towards)),
    );
    const [aside, near] = this.level_();
    return up.addScaledVector(aside, right).addScaledVector(near, towards);
  }

  /** Level unit vectors to the right of the picture and towards the viewer. */
  sides(): { right: Vec3; towards: Vec3 } {
    const [right, towards] = this.level_();
    return { right: right.toArray(), towards: towards.toArray() };
  }

  private level_(): [THREE.Vector3, THREE.Vector3] {
    const aside = new THREE.Vector3().setFromMatrixColumn(this.rig.eye.matrixWorld, 0);
    aside.setZ(0).normalize();
    return [aside, new THREE.Vector3(aside.y, -aside.x, 0)];
  }

  /** Millimeters that a CSS pixel shows at a point. */
  pixelMm(point: THREE.Vector3): number {
    return (2 * this.rig.halfHeightAt(point)) / this.height_;
  }

  /** Centers the picture on the point of the block under a canvas position (CSS pixels). */
  lookAtPixel(x: number, y: number): void {
    const { origin, direction } = this.ray(x, y);
    const point = this.tiles.pick(new THREE.Raycaster(origin, direction));
    if (point) this.rig.lookAt(point, performance.now());
  }

  /** Updates and draws one displayed frame. */
  tick(nowMs: number): void {
    const since = Math.min(100, nowMs - this.lastTickMs_);
    this.lastTickMs_ = nowMs;
    if (this.carvers.update(nowMs)) {
      this.shadowsDirty_ = true;
      this.touch();
    }
    const tip = this.followed_ === null ? null : this.carvers.tipOf(this.followed_);
    if (tip) this.rig.followPoint(tip);
    if (this.rig.update(nowMs, since)) this.touch();
    if (!this.canDraw_ || this.eyeElsewhere || this.isRecording || this.readback_?.isBusy) return;
    if (this.dirty_) {
      const pauseMs = this.readback_ ? 0 : this.quality_.pauseMs; // reading back blocks nothing
      if (nowMs - this.lastDrawMs_ >= pauseMs) this.drawMoving_(nowMs);
    } else if (!this.stillDrawn_ && nowMs - this.lastDrawMs_ > this.quality_.stillAfterMs)
      this.drawStill_(nowMs);
  }

  /** Resolves once the picture that is being drawn is shown. */
  shown(): Promise<void> {
    return this.readback_?.shown ?? Promise.resolve();
  }

  /** Compiles the shaders in parallel with the page, where the browser can, before it draws. */
  private async compile_(): Promise<void> {
    const samples = new THREE.Group().add(this.tiles.sample(), carverSample());
    await this.stage.compile(samples, this.rig.camera);
    this.canDraw_ = true;
  }

  private drawMoving_(nowMs: number): void {
    if (this.stillDrawn_) this.quality_.moved(nowMs - this.lastDrawMs_);
    else if (!this.fixedQuality) this.quality_.frame(nowMs - this.lastDrawMs_);
    this.stage.setSize(this.width_, this.height_, this.quality_.movingRatio);
    this.stage.isQuick = this.quality_.isSlow;
    this.draw_(this.shadowsDirty_ && this.quality_.takesShadows(nowMs));
    this.stage.isQuick = false;
    this.present_();
    this.dirty_ = false;
    this.stillDrawn_ = false;
    this.lastDrawMs_ = nowMs;
  }

  private drawStill_(nowMs: number): void {
    this.stage.setSize(this.width_, this.height_, this.quality_.stillRatio);
    this.draw_(this.shadowsDirty_);
    this.present_();
    this.stillDrawn_ = true;
    this.lastDrawMs_ = nowMs;
    this.quality_.rested();
  }

  private draw_(withShadows: boolean): void {
    if (withShadows) this.shadowsDirty_ = false;
    this.tiles.mergeSlabs();
    const camera = this.rig.eye;
    this.stage.render(camera, withShadows);
    for (const layer of this.layers) layer.draw?.(this.stage.renderer, camera);
    if (this.readback_) return;
    this.begun_ += 1;
    this.place_(camera, this.model.tiles.complete);
  }

  /** Shows the picture that has been drawn, if it is not on the page's canvas already. */
  private present_(): void {
    if (!this.readback_) return;
    this.begun_ += 1;
    const camera = this.rig.eye.clone(); // which may move until the picture is there
    const { complete } = this.model.tiles;
    this.readback_.show(() => this.place_(camera, complete));
  }

  /** Positions the elements of HTML in the picture that is shown now. */
  private place_(camera: THREE.Camera, hasBlock: boolean): void {
    this.shown_ += 1;
    mark('picture');
    if (hasBlock) mark('block');
    this.carvers.placeLabels(camera, this.width_, this.height_, this.clearTop_);
    for (const layer of this.layers) layer.drawn?.(camera, this.width_, this.height_);
  }
}
