// SPDX-License-Identifier: Apache-2.0
// The camera: damped orbit, pan and zoom (mouse, pen, touch), animated preset views, fit, and
// following a tool.

import * as THREE from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { boxCenter, FOV_DEG, ISO_DIRECTION, viewDistance } from '../model/fit';
import type { Insets, Viewport } from '../model/fit';
import type { Navigation } from '../model/navigation';
import type { Bounds } from '../model/session';
import { MouseButtons } from './mouse_buttons';

export type Preset = 'iso' | 'front' | 'back' | 'left' | 'right' | 'top' | 'bottom';

const DIRECTIONS: Record<Preset, readonly [number, number, number]> = {
  iso: ISO_DIRECTION,
  front: [0, -1, 0],
  back: [0, 1, 0],
  left: [-1, 0, 0],
  right: [1, 0, 0],
  top: [0, -0.0002, 1],
  bottom: [0, -0.0002, -1],
};
const FLIGHT_MS = 450;
const TRACK_MS = 90;

interface Flight {
  startMs: number;
  fromPosition: THREE.Vector3;
  fromTarget: THREE.Vector3;
  toPosition: THREE.Vector3;
  toTarget: THREE.Vector3;
}

export class CameraRig {
  readonly camera = new THREE.PerspectiveCamera(FOV_DEG, 1, 1, 1000);
  readonly controls: OrbitControls;
  /** Counts the pictures from another place than the one before. */
  moves = 0;
  /** Draw in parallel projection. */
  parallel = false;
  private readonly buttons_: MouseButtons;
  private readonly parallel_ = new THREE.OrthographicCamera();
  private readonly center_ = new THREE.Vector3();
  private readonly offset_ = new THREE.Vector3();
  private bounds_: Bounds = { min: [0, 0, 0], max: [1, 1, 1] };
  private radius_ = 100;
  private view_: Viewport = {
    width: 1,
    height: 1,
    insets: { left: 0, right: 0, top: 0, bottom: 0 },
  };
  private flight_: Flight | null = null;
  private readonly follow_ = new THREE.Vector3();
  private following_ = false;
  /** The view to which the camera keeps, eye and target; null: none. */
  private tracked_: { eye: THREE.Vector3; target: THREE.Vector3 } | null = null;
  private changed_ = true;
  /** Direction from which the block fills the view; null: the user has moved the camera. */
  private fittedFrom_: THREE.Vector3 | null = null;

  constructor(
    element: HTMLElement,
    private readonly reducedMotion: boolean,
  ) {
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, element);
    this.buttons_ = new MouseButtons(this.controls, element);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.zoomToCursor = true;
    this.controls.screenSpacePanning = true;
    let isHeld = false; // a press that moves nothing leaves the block fitted
    this.controls.addEventListener('change', () => {
      this.changed_ = true;
      if (isHeld) this.fittedFrom_ = null;
    });
    this.controls.addEventListener('start', () => {
      this.flight_ = this.tracked_ = null;
      isHeld = true;
    });
    this.controls.addEventListener('end', () => (isHeld = false));
  }

  /** What dragging with the mouse does. */
  set navigation(navigation: Navigation) {
    this.buttons_.set(navigation);
  }

  setBounds(bounds: Bounds): void {
    const min = new THREE.Vector3(...bounds.min);
    const max = new THREE.Vector3(...bounds.max);
    this.bounds_ = bounds;
    this.center_.set(...boxCenter(bounds));
    this.radius_ = Math.max(1e-3, min.distanceTo(max) / 2);
    this.camera.near = this.radius_ / 50;
    this.camera.far = this.radius_ * 40;
    this.controls.minDistance = this.radius_ / 12;
    this.controls.maxDistance = this.radius_ * 14;
  }

  resize(width: number, height: number, insets: Insets): void {
    this.view_ = { width, height, insets };
    this.camera.aspect = width / height;
    this.shift_();
    this.changed_ = true;
    if (this.fittedFrom_) this.lookFrom_(this.fittedFrom_, -Infinity);
  }

  /** Shifts the picture's center to the center of the area that no panel covers. */
  private shift_(): void {
    const { width, height, insets } = this.view_;
    const { left, right, top, bottom } = insets;
    this.camera.setViewOffset(width, height, (right - left) / 2, (bottom - top) / 2, width, height);
    this.placeParallel_();
  }

  /** Calls `draw` while the camera's target is in the middle of the whole picture. */
  centered(draw: () => void): void {
    const { insets } = this.view_;
    this.view_.insets = { left: 0, right: 0, top: 0, bottom: 0 };
    this.shift_();
    draw();
    this.view_.insets = insets;
    this.shift_();
  }

  /** The camera that draws. The controls move the one in perspective. */
  get eye(): THREE.PerspectiveCamera | THREE.OrthographicCamera {
    return this.parallel ? this.parallel_ : this.camera;
  }

  /** Half of the picture's height, mm, at a point; in parallel projection everywhere. */
  halfHeightAt(point: THREE.Vector3): number {
    const { camera, controls } = this;
    const forward = this.offset_.copy(controls.target).sub(camera.position);
    const distance = this.parallel
      ? forward.length()
      : forward.normalize().dot(point.clone().sub(camera.position));
    return Math.max(0, distance) * Math.tan((camera.fov * Math.PI) / 360);
  }

  /** Looks at the block from a direction, with the whole block in view. */
  lookFrom(direction: THREE.Vector3, nowMs: number): void {
    this.lookFrom_(direction.clone().normalize(), nowMs);
  }

  /** Moves the camera to a preset direction, with the whole block in view. */
  preset(preset: Preset, nowMs: number): void {
    this.lookFrom_(new THREE.Vector3(...DIRECTIONS[preset]).normalize(), nowMs);
  }

  /** Brings the whole block into view along the current direction. */
  fit(nowMs: number): void {
    this.lookFrom_(this.camera.position.clone().sub(this.controls.target).normalize(), nowMs);
  }

  /** Moves a point to the center of the picture. */
  lookAt(point: THREE.Vector3, nowMs: number): void {
    this.fittedFrom_ = null;
    this.fly_(this.camera.position.clone().add(point).sub(this.controls.target), point, nowMs);
  }

  /**
   * Keeps a point at the center of the picture, smoothly; null stops. Orbit and zoom stay
   * available.
   */
  followPoint(point: readonly [number, number, number] | null): void {
    this.following_ = point !== null;
    if (point) this.fittedFrom_ = null;
    if (point) this.follow_.set(...point);
  }

  /** Moves the camera to a place from which it looks at a point. */
  view(eye: THREE.Vector3, target: THREE.Vector3, nowMs: number): void {
    this.fittedFrom_ = null;
    this.fly_(eye, target, nowMs);
  }

  /** Keeps to a view that may move, until the camera is moved otherwise; null ends it. */
  track(view: { eye: THREE.Vector3; target: THREE.Vector3 } | null): void {
    this.tracked_ = view;
    if (!view) return;
    this.fittedFrom_ = this.flight_ = null;
  }

  /** A distance from which a detail of the block is seen with its surroundings. */
  get closeMm(): number {
    return 1.6 * this.radius_;
  }

  get tracks(): boolean {
    return this.tracked_ !== null;
  }

  orbit(aroundRad: number, upRad: number): void {
    this.fittedFrom_ = this.tracked_ = null;
    const arm = this.offset_.copy(this.camera.position).sub(this.controls.target);
    const polar = Math.acos(THREE.MathUtils.clamp(arm.z / arm.length(), -1, 1));
    const toPolar = THREE.MathUtils.clamp(polar - upRad, 0.001, Math.PI - 0.001);
    const azimuth = Math.atan2(arm.y, arm.x) + aroundRad;
    const length = arm.length();
    arm.set(
      Math.sin(toPolar) * Math.cos(azimuth),
      Math.sin(toPolar) * Math.sin(azimuth),
      Math.cos(toPolar),
    );
    this.camera.position.copy(this.controls.target).addScaledVector(arm, length);
    this.changed_ = true;
  }

  /** Pans by fractions of the view's height. */
  pan(right: number, up: number): void {
    this.fittedFrom_ = this.tracked_ = null;
    const reach =
      this.camera.position.distanceTo(this.controls.target) *
      Math.tan((this.camera.fov * Math.PI) / 360) *
      2;
    const move = new THREE.Vector3()
      .addScaledVector(
        new THREE.Vector3().setFromMatrixColumn(this.camera.matrix, 0),
        right * reach,
      )
      .addScaledVector(new THREE.Vector3().setFromMatrixColumn(this.camera.matrix, 1), up * reach);
    this.camera.position.add(move);
    this.controls.target.add(move);
    this.changed_ = true;
  }

  zoom(factor: number): void {
    this.fittedFrom_ = this.tracked_ = null;
    const arm = this.offset_.copy(this.camera.position).sub(this.controls.target);
    const length = THREE.MathUtils.clamp(
      arm.length() * factor,
      this.controls.minDistance,
      this.controls.maxDistance,
    );
    this.camera.position.copy(this.controls.target).addScaledVector(arm.normalize(), length);
    this.changed_ = true;
  }

  /** Advances animation, following and damping. Returns true if the picture changed. */
  update(nowMs: number, sinceMs: number): boolean {
    if (this.flight_) this.advance_(this.flight_, nowMs);
    else if (this.tracked_) this.keepTo_(this.tracked_, sinceMs);
    else if (this.following_) this.chase_(sinceMs);
    this.controls.update();
    const changed = this.changed_;
    this.changed_ = false;
    if (changed) this.moves += 1;
    if (changed || this.parallel) this.placeParallel_();
    return changed;
  }

  /** Shows the camera's target as the camera in perspective shows it. */
  private placeParallel_(): void {
    const { camera, parallel_: eye } = this;
    const { width, height, insets } = this.view_;
    const half = this.halfHeightAt(this.controls.target);
    const reach = 40 * this.radius_;
    Object.assign(eye, { top: half, bottom: -half, near: -reach, far: reach });
    Object.assign(eye, { right: half * camera.aspect, left: -half * camera.aspect });
    const { left, right, top, bottom } = insets;
    // Also updates the projection.
    eye.setViewOffset(width, height, (right - left) / 2, (bottom - top) / 2, width, height);
    eye.position.copy(camera.position);
    eye.quaternion.copy(camera.quaternion);
    eye.updateMatrixWorld();
  }

  private keepTo_(
    { eye, target }: { eye: THREE.Vector3; target: THREE.Vector3 },
    sinceMs: number,
  ): void {
    const { camera, controls } = this;
    const far = camera.position.distanceTo(eye) + controls.target.distanceTo(target);
    if (far < 1e-5 * this.radius_) return;
    const part = this.reducedMotion ? 1 : 1 - Math.exp(-sinceMs / TRACK_MS);
    camera.position.lerp(eye, part);
    controls.target.lerp(target, part);
    this.changed_ = true;
  }

  private chase_(sinceMs: number): void {
    const step = this.offset_
      .copy(this.follow_)
      .sub(this.controls.target)
      .multiplyScalar(1 - Math.exp(-sinceMs / 180));
    if (step.lengthSq() < 1e-10 * this.radius_ * this.radius_) return;
    this.controls.target.add(step);
    this.camera.position.add(step);
    this.changed_ = true;
  }

  /** `nowMs` -Infinity: at once. */
  private lookFrom_(direction: THREE.Vector3, nowMs: number): void {
    this.fittedFrom_ = direction;
    const distance = viewDistance(this.bounds_, direction.toArray(), this.view_);
    this.fly_(this.center_.clone().addScaledVector(direction, distance), this.center_, nowMs);
  }

  private fly_(position: THREE.Vector3, target: THREE.Vector3, nowMs: number): void {
    this.tracked_ = null;
    this.flight_ = {
      startMs: this.reducedMotion ? -Infinity : nowMs,
      fromPosition: this.camera.position.clone().sub(this.controls.target),
      fromTarget: this.controls.target.clone(),
      toPosition: position.clone().sub(target),
      toTarget: target.clone(),
    };
    // The first view is not animated.
    if (this.flight_.fromPosition.lengthSq() === 0) this.flight_.startMs = -Infinity;
    if (this.flight_.startMs === -Infinity) this.advance_(this.flight_, performance.now());
  }

  /**
   * Interpolates direction and distance separately, so that the camera does not pass through the
   * block.
   */
  private advance_(flight: Flight, nowMs: number): void {
    const linear = Math.min(1, (nowMs - flight.startMs) / FLIGHT_MS);
    const part = linear * linear * (3 - 2 * linear);
    const arm = flight.toPosition.clone().normalize();
    if (part < 1) {
      const from = flight.fromPosition.clone().normalize();
      const turn = new THREE.Quaternion().setFromUnitVectors(from, arm);
      arm.copy(from).applyQuaternion(new THREE.Quaternion().slerp(turn, part));
    }
    const length = THREE.MathUtils.lerp(
      flight.fromPosition.length(),
      flight.toPosition.length(),
      part,
    );
    this.controls.target.lerpVectors(flight.fromTarget, flight.toTarget, part);
    this.camera.position.copy(this.controls.target).addScaledVector(arm, length);
    if (part >= 1) this.flight_ = null;
    this.changed_ = true;
  }
}
