// SPDX-License-Identifier: Apache-2.0
// From a pointer's ray to the pose of a tool. Depths are measured from the surface as it was when the
// stroke began, so that going over a place twice does not dig. Pure: no browser, no three.js.

import type { Bounds } from '../model/session';
import type { OutlinePoint, ToolProfile } from '../model/tool_profile';
import type { Vec3 } from '../wire/types';
import type { Pose } from './tool/path_queue';
import type { Hit } from '../model/surface';
import type { Ray } from './surface';
import { across, distance, dot, minus, plus, unitOf } from '../model/vector';
import { leaningFrom, meetsAbove } from './clearance';
import { angleBetween, lerp, turned } from './tool/vectors';

/** `surface`: the tip follows the surface; `plane`: it stays on a plane through the stroke's start. */
export type AimMode = 'surface' | 'plane';

/**
 * The tool's axis: across the surface; vertical, as on a machine with three axes; or that of a pen
 * that tells its tilt, and without one across the surface.
 */
export type AxisChoice = 'surface' | 'vertical' | 'pen';
export const AXIS_CHOICES: readonly AxisChoice[] = ['surface', 'vertical', 'pen'];

export interface AimSettings {
  mode: AimMode;
  depthMm: number;
  axis: AxisChoice;
}

/** The line of sight through a pointer. */
export interface Sight extends Ray {
  /** The axis of a pen, from its tip to its end, unit length. */
  pen?: Vec3 | null;
}

/** The surface at one moment. */
export interface Probed {
  /** The first place where a ray enters the block, within `reach` mm; null if it does not. */
  hit(ray: Ray, reach?: number): Hit | null;
  smoothNormal(hit: Hit, around: readonly Vec3[], radius: number): Vec3;
  /** The part around a point, where rays are faster. */
  near?(point: Vec3, radius: number): Pick<Probed, 'hit'>;
}

const UP: Vec3 = [0, 0, 1];
const TURN_PER_RADIUS = 1.5; // of the axis, rad while the tool goes its radius
const LEAN_MAX_RAD = 1.2; // from the normal, of an axis that is kept
const PROBES = 6;
const LIFT_MM = 1; // of a tool that waits over the surface

/**
 * How far a tool reaches below its tip's tangent plane, mm: the largest height of its outline
 * against the normal, when the axis is at `angle` to it. 0 for a tool that stands on its tip.
 */
function reachBelow(outline: readonly OutlinePoint[], angle: number): number {
  const [sine, cosine] = [Math.sin(angle), Math.cos(angle)];
  return Math.max(0, ...outline.map(([r, z]) => r * sine - z * cosine));
}

/**
 * Returns the tip with which a tool cuts `depthMm` below the plane through `point`, and with which
 * shank and holder stay above that plane. The tool touches with whatever is lowest, so a ball cuts
 * as deep on a slope as on a level. Null if the surface faces away from the axis.
 */
export function tipOn(
  point: Vec3,
  normal: Vec3,
  axis: Vec3,
  depthMm: number,
  { pieces, body }: Pick<ToolProfile, 'pieces' | 'body'>,
): Vec3 | null {
  const angle = angleBetween(axis, normal);
  if (angle > Math.PI / 2 + 1e-6) return null;
  const cutter = reachBelow(pieces.flat(), angle) - depthMm;
  const clear = body.pieces.length === 0 ? -Infinity : bodyLift(body.pieces.flat(), angle);
  return plus(point, normal, Math.max(cutter, clear));
}

/** The lift with which a body, which begins above the tip, touches the tangent plane. */
function bodyLift(outline: readonly OutlinePoint[], angle: number): number {
  const [sine, cosine] = [Math.sin(angle), Math.cos(angle)];
  return Math.max(...outline.map(([r, z]) => r * sine - z * cosine));
}

interface Stroke {
  /** Of the plane mode: a point of the surface, and the axis. */
  origin: Vec3;
  axis: Vec3;
}

export class Aim {
  private normal_: Vec3 | null = null; // smoothed along the path
  private last_: Vec3 | null = null; // the last place on the surface
  private axis_: Vec3 = UP;
  private touches_ = false; // with its side, shank or holder
  private touched_: { point: Vec3; normal: Vec3 } | null = null; // by the newest pose
  private stroke_: Stroke | null = null;

  constructor(
    private readonly profile: ToolProfile,
    private readonly bounds: Bounds,
    readonly settings: AimSettings,
  ) {}

  /**
   * Where the tool would cut; null if the pointer misses the block, or the tool cannot get there.
   */
  hover(surface: Probed, ray: Sight): Pose | null {
    const hit = surface.hit(ray);
    return hit && this.onSurface_(surface, hit, ray.pen);
  }

  /** Begins a stroke; null: there is nothing to cut under the pointer. */
  begin(surface: Probed, ray: Sight): Pose | null {
    const hit = surface.hit(ray);
    const pose = hit && this.onSurface_(surface, hit, ray.pen);
    if (!pose) return null;
    this.stroke_ = { origin: hit.point, axis: pose.axis };
    return this.settings.mode === 'plane' ? this.onPlane_(ray, this.stroke_) : pose;
  }

  /** Continues a stroke; null: the tool stays where it is. */
  move(surface: Probed, ray: Sight): Pose | null {
    const stroke = this.stroke_;
    if (!stroke) return null;
    if (this.settings.mode === 'plane') {
      this.touched_ = null;
      return this.onPlane_(ray, stroke);
    }
    const hit = surface.hit(ray);
    // A stroke may run over the edge: there the tool continues at the same height.
    return hit
      ? this.onSurface_(surface, hit, ray.pen)
      : this.onPlane_(ray, { ...stroke, origin: this.last_! });
  }

  /** The pose to which move() would lead, without going there. */
  peek(surface: Probed, ray: Sight): Pose | null {
    const { normal_, last_, axis_, touched_ } = this;
    const pose = this.move(surface, ray);
    Object.assign(this, { normal_, last_, axis_, touched_ });
    return pose;
  }

  /**
   * How far the surface under a pointer is from the last place of the stroke, mm; 0 where the tool
   * does not follow the surface.
   */
  farTo(surface: Probed, ray: Ray): number {
    const hit = this.settings.mode === 'surface' && this.last_ ? surface.hit(ray) : null;
    return hit ? distance(this.last_!, hit.point) : 0;
  }

  /** Whether the newest tool across the surface meets the block with its side, shank or holder. */
  get touches(): boolean {
    return this.touches_;
  }

  get radiusMm(): number {
    return this.profile.radiusMm;
  }

  end(): void {
    this.stroke_ = null;
    this.normal_ = null;
    this.last_ = null;
  }

  /** The same pose, clear of the surface: along its normal, or along the axis out of a plane. */
  lifted({ tip, axis }: Pose): Pose {
    if (!this.touched_) return { tip: plus(tip, axis, this.settings.depthMm + LIFT_MM), axis };
    const { point, normal } = this.touched_;
    const { pieces, body } = this.profile;
    const outline = [...pieces, ...body.pieces].flat();
    const reach = reachBelow(outline, angleBetween(axis, normal));
    const below = reach - dot(minus(tip, point), normal);
    return { tip: plus(tip, normal, Math.max(0, below) + LIFT_MM), axis };
  }

  private onSurface_(surface: Probed, hit: Hit, pen: Vec3 | null = null): Pose | null {
    const radius = this.probeRadius_();
    const moved = this.last_ ? distance(this.last_, hit.point) : Infinity;
    const probed = surface.smoothNormal(hit, ring(hit.normal), radius);
    const normal = this.smoothed_(probed, moved, radius);
    for (const axis of this.axes_(surface, hit.point, normal, pen, moved / radius)) {
      const tip = tipOn(hit.point, normal, axis, this.settings.depthMm, this.profile);
      if (!tip) continue;
      this.last_ = hit.point;
      this.touched_ = { point: hit.point, normal };
      this.axis_ = axis;
      return { tip, axis };
    }
    return null;
  }

  /**
   * The axes that the settings allow on a surface, the best one first. `radii`: how far the tool has
   * come, in its radii; within a stroke the axis turns no faster than that allows.
   */
  private axes_(
    surface: Probed,
    point: Vec3,
    normal: Vec3,
    pen: Vec3 | null,
    radii: number,
  ): Vec3[] {
    const { axis: choice } = this.settings;
    this.touches_ = false;
    if (choice === 'vertical') return [UP];
    const across = this.clearAxis_(surface, point, normal);
    const wanted = choice === 'pen' && pen ? [pen, across] : [across];
    if (!this.stroke_) return wanted;
    const most = TURN_PER_RADIUS * radii;
    const slow = wanted.map((axis) =>
      angleBetween(this.axis_, axis) > most ? turned(this.axis_, axis, most) : axis,
    );
    return [...slow, ...wanted]; // the surface may have turned away from a slow axis
  }

  /** The normal; or the axis next to it with which side, shank and holder are clear, if there is one. */
  private clearAxis_(surface: Probed, point: Vec3, normal: Vec3): Vec3 {
    const { profile } = this;
    const { depthMm } = this.settings;
    const reach = Math.max(profile.lengthMm, profile.body.topMm) + 2 * profile.radiusMm;
    const near = surface.near?.(point, reach) ?? surface;
    const isClear = (axis: Vec3): boolean => {
      const tip = tipOn(point, normal, axis, depthMm, profile);
      return tip !== null && !meetsAbove(near, { tip, axis }, profile, depthMm);
    };
    if (isClear(normal)) return normal;
    const kept = angleBetween(this.axis_, normal) < LEAN_MAX_RAD ? [this.axis_] : [];
    for (const axis of [...kept, ...leaningFrom(normal)]) if (isClear(axis)) return axis;
    this.touches_ = true;
    return normal;
  }

  /** Half the part of the tool that is in the stock; a wide tool does not smooth its own path away. */
  private probeRadius_(): number {
    return Math.max(0.05, this.profile.radiusMm / 2);
  }

  private smoothed_(normal: Vec3, moved: number, radius: number): Vec3 {
    const known = this.stroke_ ? this.normal_ : null;
    this.normal_ = known ? unitOf(lerp(known, normal, 1 - Math.exp(-moved / radius))) : normal;
    return this.normal_;
  }

  private onPlane_({ origin, direction }: Ray, stroke: Stroke): Pose | null {
    const axis = this.settings.mode === 'plane' ? stroke.axis : this.axis_;
    const start = plus(stroke.origin, axis, -this.settings.depthMm);
    const at = dot(minus(start, origin), axis) / dot(direction, axis);
    const tip = plus(origin, direction, at);
    return at > 0 && this.isNear_(tip) ? { tip, axis } : null;
  }

  /** Within two diameters of the block: a stroke does not run away to the horizon. */
  private isNear_(tip: Vec3): boolean {
    const margin = 4 * this.profile.radiusMm;
    const { min, max } = this.bounds;
    return [0, 1, 2].every((i) => tip[i]! >= min[i]! - margin && tip[i]! <= max[i]! + margin);
  }
}

/** Directions around a normal, of length 1, in its plane. */
function ring(normal: Vec3): Vec3[] {
  const [right, front] = across(normal);
  return Array.from({ length: PROBES }, (_, n) => {
    const angle = (2 * Math.PI * n) / PROBES;
    return plus(plus([0, 0, 0], right, Math.cos(angle)), front, Math.sin(angle));
  });
}
