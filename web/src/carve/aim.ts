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
import { angleBetween, lerp, turned } from './tool/vectors';

/** `surface`: the tip follows the surface; `plane`: it stays on a plane through the stroke's start. */
export type AimMode = 'surface' | 'plane';

export interface AimSettings {
  mode: AimMode;
  depthMm: number;
  /**
   * The axis leans from the vertical by at most this, towards the normal, or as a pen does that
   * tells its tilt; 0: it stays vertical.
   */
  leanMaxRad: number;
}

/** The line of sight through a pointer. */
export interface Sight extends Ray {
  /** The axis of a pen, from its tip to its end, unit length. */
  pen?: Vec3 | null;
}

/** The surface at one moment. */
export interface Probed {
  hit(ray: Ray): Hit | null;
  smoothNormal(hit: Hit, around: readonly Vec3[], radius: number): Vec3;
}

export const LEAN_MAX_RAD = Math.PI / 4;
const UP: Vec3 = [0, 0, 1];
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

/** The vertical axis, leaned towards a direction. */
export function leaned(direction: Vec3, leanMaxRad: number): Vec3 {
  const angle = angleBetween(UP, direction);
  if (leanMaxRad === 0 || angle < 1e-6) return UP;
  const towards = Math.PI - angle < 1e-6 ? across(UP)[0] : direction;
  return turned(UP, towards, Math.min(angle, leanMaxRad));
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
    // Beside the block the tool goes on level, so that a stroke may run over the edge.
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
    const normal = this.smoothed_(surface.smoothNormal(hit, ring(hit.normal), radius), hit, radius);
    const { depthMm, leanMaxRad } = this.settings;
    // A surface that faces away from a pen is reached as without one.
    for (const towards of pen ? [pen, normal] : [normal]) {
      const axis = leaned(towards, leanMaxRad);
      const tip = tipOn(hit.point, normal, axis, depthMm, this.profile);
      if (!tip) continue;
      this.last_ = hit.point;
      this.touched_ = { point: hit.point, normal };
      this.axis_ = axis;
      return { tip, axis };
    }
    return null;
  }

  /** Half the part of the tool that is in the stock; a wide tool does not smooth its own path away. */
  private probeRadius_(): number {
    return Math.max(0.05, this.profile.radiusMm / 2);
  }

  private smoothed_(normal: Vec3, { point }: Hit, radius: number): Vec3 {
    const known = this.stroke_ ? this.normal_ : null;
    const moved = this.last_ ? distance(this.last_, point) : Infinity;
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
