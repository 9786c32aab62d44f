// SPDX-License-Identifier: Apache-2.0
// The section plane: its position, its display, and its area.

import type { Camera } from 'three';
import { Vector3 } from 'three';
import type { LengthUnit } from '../../model/measure';
import { lengthText } from '../../model/measure';
import { footOf, offsetsOf, sectionOf } from '../../model/section';
import type { Plane, Section } from '../../model/section';
import type { Bounds } from '../../model/session';
import { dot, scaled } from '../../model/vector';
import type { DisplayedSurface } from '../../view/displayed_surface';
import { SectionView } from '../../view/inspect/section_view';
import type { Viewer } from '../../view/viewer';
import type { Vec3 } from '../../wire/types';
import { Handle } from './handle';
import { SectionControls } from './section_controls';
import type { Direction } from './section_controls';

const AXES: Record<'x' | 'y' | 'z', Vec3> = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };
/** The plane along a face is this much of the block's extent inside of it. */
const INSIDE = 0.02;
/** The plane stays this much of the block's extent inside of it. */
const MARGIN = 1e-4;

export class Sectioning {
  /** A direction was chosen, or a face is to be pressed. */
  chosen: () => void = () => undefined;
  private readonly view_: SectionView;
  private readonly controls_ = new SectionControls({
    direction: (direction) => this.choose(direction),
    place: (mm) => this.place_(mm),
    flip: () => this.flip_(),
    face: () => this.faceOn_(),
  });
  private readonly handle_: Handle;
  private direction_: Direction = 'none';
  /** The axis, or out of the face. */
  private base_: Vec3 = [0, 0, 1];
  private mm_ = 0;
  private flipped_ = false;
  private section_: Section | null = null;
  private computed_ = '';
  private isExact_ = false;
  private units_: LengthUnit = 'mm';
  waitsForFace = false;

  constructor(
    private readonly viewer: Viewer,
    private readonly surface: DisplayedSurface,
    private readonly bounds: () => Bounds,
  ) {
    this.view_ = new SectionView(viewer);
    this.handle_ = new Handle(
      (offset) => this.place_(this.flipped_ ? -offset : offset),
      () => this.extent_() / 100,
    );
  }

  get element(): HTMLElement {
    return this.controls_.element;
  }

  get handle(): HTMLElement {
    return this.handle_.element;
  }

  /** null: there is no section. */
  get plane(): Plane | null {
    if (this.direction_ === 'none') return null;
    const sign = this.flipped_ ? -1 : 1;
    return { normal: scaled(this.base_, sign), offset: sign * this.mm_ };
  }

  get outline(): ArrayLike<number> {
    return this.section_?.lines ?? [];
  }

  /** Through the middle of the block, with the side of the viewer cut away. */
  choose(direction: Direction): void {
    this.chosen();
    this.waitForFace(direction === 'face');
    if (direction === 'face') return;
    this.direction_ = direction;
    if (direction !== 'none') {
      const base = AXES[direction];
      const { min, max } = this.bounds();
      const [least, greatest] = offsetsOf(base, min, max);
      const eye = this.viewer.rig.camera.position.toArray();
      const target = this.viewer.rig.controls.target.toArray();
      this.base_ = base;
      this.flipped_ = dot(base, eye) < dot(base, target);
      this.mm_ = (least + greatest) / 2;
    }
    this.apply_();
  }

  /** A face is to be pressed in the picture, or no more. */
  waitForFace(waits: boolean): void {
    this.waitsForFace = waits;
    this.showDirection_();
  }

  /** Along a face, a little inside of it. */
  along(point: Vec3, normal: Vec3): void {
    this.direction_ = 'face';
    this.base_ = normal;
    this.flipped_ = false;
    this.mm_ = dot(point, normal) - INSIDE * this.extent_();
    this.waitForFace(false);
    this.apply_();
  }

  setUnits(units: LengthUnit): void {
    this.units_ = units;
    this.apply_();
  }

  /**
   * Computes outline and area again if the surface has changed.
   * @param isExact no displayed tile is coarser than the block
   */
  update(isExact: boolean): void {
    const key = `${this.surface.changes} ${isExact}`;
    if (key === this.computed_) return;
    this.computed_ = key;
    this.isExact_ = isExact;
    this.compute_();
  }

  placeHandle(camera: Camera, width: number, height: number): void {
    if (!this.plane) return;
    const pixelMm = this.viewer.pixelMm(new Vector3(...this.anchor_));
    this.handle_.place(camera, width, height, pixelMm);
  }

  /** Where the handle is: in the plane, at the middle of the block. */
  private get anchor_(): Vec3 {
    const { min, max } = this.bounds();
    const middle = scaled([min[0] + max[0], min[1] + max[1], min[2] + max[2]], 0.5);
    return this.plane ? footOf(middle, this.plane) : middle;
  }

  private extent_(): number {
    const [least, greatest] = this.range_();
    return greatest - least;
  }

  private range_(): [number, number] {
    const { min, max } = this.bounds();
    return offsetsOf(this.base_, min, max);
  }

  private place_(mm: number): void {
    const [least, greatest] = this.range_();
    const margin = MARGIN * (greatest - least);
    this.mm_ = Math.min(greatest - margin, Math.max(least + margin, mm));
    this.apply_();
  }

  private flip_(): void {
    this.flipped_ = !this.flipped_;
    this.apply_();
  }

  private faceOn_(): void {
    if (!this.plane) return;
    const [x, y, z] = this.plane.normal;
    // Straight from above or below, y points up.
    const isUpright = Math.hypot(x, y) < 1e-3;
    const direction = new Vector3(x, isUpright ? -0.0002 : y, z);
    this.viewer.rig.lookFrom(direction, performance.now());
  }

  private apply_(): void {
    const { plane } = this;
    const bounds = this.bounds();
    this.view_.set(plane, bounds);
    this.showDirection_();
    this.controls_.showPlace(plane ? this.mm_ : null, this.units_);
    const place = lengthText(this.mm_, this.units_);
    this.handle_.show(plane, this.anchor_, place);
    requestAnimationFrame(() => this.compute_());
  }

  private compute_(): void {
    const { plane } = this;
    this.section_ = plane && sectionOf(this.surface.pieces, plane);
    if (!this.section_) return;
    this.view_.setOutline(this.section_);
    this.controls_.showArea(this.section_, this.isExact_);
  }

  private showDirection_(): void {
    const direction = this.waitsForFace ? 'face' : this.direction_;
    this.controls_.showDirection(direction, this.range_());
  }
}
