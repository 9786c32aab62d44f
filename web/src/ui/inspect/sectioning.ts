// SPDX-License-Identifier: Apache-2.0
// The section plane: its position, its display, and its area.

import { batch, signal } from '@preact/signals';
import type { Camera } from 'three';
import { Vector3 } from 'three';
import { footOf, offsetsOf, sectionOf } from '../../model/section';
import type { Plane, Section } from '../../model/section';
import type { Bounds } from '../../model/session';
import { dot, scaled } from '../../model/vector';
import type { DisplayedSurface } from '../../view/displayed_surface';
import { SectionView } from '../../view/inspect/section_view';
import type { Viewer } from '../../view/viewer';
import type { Vec3 } from '../../wire/types';
import { Handle } from './handle';
import type { Direction, SectionActions, ShownSection } from './section_controls';

const AXES: Record<'x' | 'y' | 'z', Vec3> = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };
/** The plane along a face is this much of the block's extent inside of it. */
const INSIDE = 0.02;
/** The plane stays this much of the block's extent inside of it. */
const MARGIN = 1e-4;

/** Where the plane is. */
interface Placed {
  direction: Direction;
  /** The axis, or out of the face. */
  base: Vec3;
  mm: number;
  /** The other side is cut away. */
  isFlipped: boolean;
}

export class Sectioning {
  /** A direction was chosen, or a face is to be pressed. */
  chosen: () => void = () => undefined;
  private readonly view_: SectionView;
  readonly actions: SectionActions = {
    direction: (direction) => this.choose(direction),
    place: (mm) => this.place_(mm),
    flip: () => this.flip_(),
    face: () => this.faceOn_(),
  };
  readonly handle = new Handle();
  private readonly placed_ = signal<Placed>({
    ...{ direction: 'none', base: [0, 0, 1], mm: 0, isFlipped: false },
  });
  private readonly section_ = signal<Section | null>(null);
  private readonly isExact_ = signal(false);
  private readonly waitsForFace_ = signal(false);
  private computed_ = '';

  constructor(
    private readonly viewer: Viewer,
    private readonly surface: DisplayedSurface,
    private readonly bounds: () => Bounds,
  ) {
    this.view_ = new SectionView(viewer);
  }

  // The properties are tracked as signals are.

  /** Null: there is no section. */
  get plane(): Plane | null {
    const { direction, base, mm, isFlipped } = this.placed_.value;
    if (direction === 'none') return null;
    const sign = isFlipped ? -1 : 1;
    return { normal: scaled(base, sign), offset: sign * mm };
  }

  get outline(): ArrayLike<number> {
    return this.section_.value?.lines ?? [];
  }

  /** Whether the next press in the picture gives the face of the section. */
  get waitsForFace(): boolean {
    return this.waitsForFace_.value;
  }

  get shown(): ShownSection {
    const { direction, mm } = this.placed_.value;
    return {
      direction: this.waitsForFace ? 'face' : direction,
      range: this.range_(),
      mm: direction === 'none' ? null : mm,
      section: this.section_.value,
      isExact: this.isExact_.value,
    };
  }

  /** The step of the handle by a key, mm. */
  get stepMm(): number {
    return this.extent_() / 100;
  }

  /** Moves the plane; the offset is along its normal. */
  moveTo(offset: number): void {
    this.place_(this.placed_.peek().isFlipped ? -offset : offset);
  }

  /** Through the middle of the block, with the side of the viewer cut away. */
  choose(direction: Direction): void {
    this.chosen();
    this.waitForFace(direction === 'face');
    if (direction === 'face') return;
    if (direction === 'none') {
      this.apply_({ direction });
      return;
    }
    const base = AXES[direction];
    const { min, max } = this.bounds();
    const [least, greatest] = offsetsOf(base, min, max);
    const eye = this.viewer.rig.camera.position.toArray();
    const target = this.viewer.rig.controls.target.toArray();
    const isFlipped = dot(base, eye) < dot(base, target);
    this.apply_({ direction, base, isFlipped, mm: (least + greatest) / 2 });
  }

  /** A face is to be pressed in the picture, or no more. */
  waitForFace(waits: boolean): void {
    this.waitsForFace_.value = waits;
  }

  /** Along a face, a little inside of it. */
  along(point: Vec3, normal: Vec3): void {
    const { min, max } = this.bounds();
    const [least, greatest] = offsetsOf(normal, min, max);
    const mm = dot(point, normal) - INSIDE * (greatest - least);
    this.waitForFace(false);
    this.apply_({ direction: 'face', base: normal, isFlipped: false, mm });
  }

  /**
   * Computes outline and area again if the surface has changed.
   * @param isExact no displayed tile is coarser than the block
   */
  update(isExact: boolean): void {
    const key = `${this.surface.changes} ${isExact}`;
    if (key === this.computed_) return;
    this.computed_ = key;
    this.isExact_.value = isExact;
    this.compute_();
  }

  placeHandle(camera: Camera, width: number, height: number): void {
    const { plane } = this;
    if (!plane) return;
    const anchor = this.anchorOf_(plane);
    const pixelMm = this.viewer.pixelMm(new Vector3(...anchor));
    this.handle.update(plane, anchor, camera, [width, height], pixelMm);
  }

  /** The place of the handle: in the plane, at the middle of the block. */
  private anchorOf_(plane: Plane): Vec3 {
    const { min, max } = this.bounds();
    const middle = scaled([min[0] + max[0], min[1] + max[1], min[2] + max[2]], 0.5);
    return footOf(middle, plane);
  }

  private extent_(): number {
    const [least, greatest] = this.range_();
    return greatest - least;
  }

  private range_(): [number, number] {
    const { min, max } = this.bounds();
    return offsetsOf(this.placed_.value.base, min, max);
  }

  private place_(mm: number): void {
    const [least, greatest] = this.range_();
    const margin = MARGIN * (greatest - least);
    this.apply_({ mm: Math.min(greatest - margin, Math.max(least + margin, mm)) });
  }

  private flip_(): void {
    this.apply_({ isFlipped: !this.placed_.peek().isFlipped });
  }

  private faceOn_(): void {
    if (!this.plane) return;
    const [x, y, z] = this.plane.normal;
    // Straight from above or below, y points up.
    const isUpright = Math.hypot(x, y) < 1e-3;
    const direction = new Vector3(x, isUpright ? -0.0002 : y, z);
    this.viewer.rig.lookFrom(direction, performance.now());
  }

  private apply_(change: Partial<Placed>): void {
    batch(() => {
      this.placed_.value = { ...this.placed_.peek(), ...change };
      this.section_.value = null;
    });
    this.view_.set(this.plane, this.bounds());
    requestAnimationFrame(() => this.compute_());
  }

  private compute_(): void {
    const { plane } = this;
    const section = plane && sectionOf(this.surface.pieces, plane);
    this.section_.value = section;
    if (section) this.view_.setOutline(section);
  }
}
