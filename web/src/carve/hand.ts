// SPDX-License-Identifier: Apache-2.0
// The tool in the hand: where the pointer puts it, how it is drawn, and the samples of its path.

import { stockBounds } from '../model/session';
import { toolProfile } from '../model/tool_profile';
import { ToolView } from '../view/tool_view';
import type { Viewer } from '../view/viewer';
import type { ToolInfo, Welcome } from '../wire/types';
import { Aim } from './aim';
import type { AimSettings } from './aim';
import type { Place } from './pointers';
import type { Draft } from './sample_log';
import { Sampler } from './sampler';
import type { Pose, SamplerLimits } from './sampler';
import { bounded, Surface } from './surface';
import type { Ray } from './surface';

const STEP_PX = 4; // a jump of the pointer is divided, so that the tip follows the surface in between
const STEPS_MAX = 12;

export class Hand {
  readonly settings: AimSettings = { mode: 'surface', depthMm: 1, leanMaxRad: 0 };
  private readonly sampler_ = new Sampler(0);
  private aim_: Aim | null = null;
  private tool_: ToolView | null = null;
  private welcome_: Welcome | null = null;
  private surface_: { changes: number; surface: Surface } | null = null;
  private frozen_: Surface | null = null; // while a stroke lasts
  private last_: { place: Place; pose: Pose } | null = null;

  /** `moved`: the tool is drawn at a place, or nowhere. */
  constructor(
    private readonly viewer: Viewer,
    private readonly moved: (place: Place | null) => void,
  ) {}

  set limits(limits: SamplerLimits) {
    this.sampler_.limits = limits;
  }

  /** Takes a tool of the session. A stroke must have ended. */
  takeTool(tool: ToolInfo, color: string, welcome: Welcome): void {
    if (welcome !== this.welcome_) this.surface_ = null;
    this.welcome_ = welcome;
    this.aim_ = new Aim(toolProfile(tool), stockBounds(welcome.stock), this.settings);
    this.sampler_.tool = tool.id;
    this.hide();
    this.tool_?.dispose();
    this.tool_ = new ToolView(tool, color, welcome.pivot_mm);
    this.tool_.group.visible = false;
    this.viewer.stage.scene.add(this.tool_.group);
  }

  get isCutting(): boolean {
    return this.frozen_ !== null;
  }

  /** Shows where the tool would cut; `isSent`: others see it too. */
  hover(place: Place | null, isSent: boolean): void {
    const pose = place && this.aim_?.hover(this.current_(), this.ray_(place));
    if (!place || !pose) {
      this.hide();
      return;
    }
    this.show_(place, pose);
    if (isSent) this.sampler_.push(this.aim_!.lifted(pose), false);
  }

  /** Shows it again where it is, after a change of the settings. */
  hoverAgain(isSent: boolean): void {
    if (this.last_ && !this.frozen_) this.hover(this.last_.place, isSent);
  }

  /** Begins a stroke, if the tool gets to the block there. */
  begin(place: Place, depthMm: number): void {
    const surface = this.current_();
    this.press_(place, depthMm);
    const pose = this.aim_?.begin(surface, this.ray_(place));
    if (!this.aim_ || !pose) return;
    this.frozen_ = surface;
    this.sampler_.push(this.aim_.lifted(pose), false);
    this.cutTo_(place, pose);
  }

  move(places: readonly Place[], depthMm: number): void {
    for (const place of places) {
      const from = this.last_?.place;
      if (!from || !this.frozen_) return;
      const jump = Math.hypot(place.x - from.x, place.y - from.y);
      const steps = Math.min(STEPS_MAX, Math.max(1, Math.ceil(jump / STEP_PX)));
      this.press_(place, depthMm);
      for (let n = 1; n <= steps; ++n) {
        const part = n / steps;
        const x = from.x + part * (place.x - from.x);
        const y = from.y + part * (place.y - from.y);
        const pose = this.aim_?.move(this.frozen_, this.ray_({ x, y }));
        if (pose) this.cutTo_({ ...place, x, y }, pose);
      }
    }
  }

  /** Lifts the tool. */
  end(): void {
    if (this.frozen_ && this.aim_ && this.last_) {
      this.sampler_.push(this.aim_.lifted(this.last_.pose), false);
    }
    this.frozen_ = null;
    this.aim_?.end();
  }

  hide(): void {
    this.last_ = null;
    this.moved(null);
    if (!this.tool_?.group.visible) return;
    this.tool_.group.visible = false;
    this.viewer.touchAll();
  }

  /** Drops what is not sent yet. */
  forget(): void {
    this.sampler_.forget();
  }

  /** The samples that are due. */
  take(nowUs: number): Draft[] {
    return this.sampler_.take(nowUs);
  }

  private cutTo_(place: Place, pose: Pose): void {
    this.show_(place, pose);
    this.sampler_.push(pose, true);
  }

  /** A pen that is pressed lightly cuts less deep. */
  private press_({ pressure }: Place, depthMm: number): void {
    this.settings.depthMm = depthMm * (pressure ?? 1);
  }

  private ray_({ x, y }: Pick<Place, 'x' | 'y'>): Ray {
    const { origin, direction } = this.viewer.ray(x, y);
    return { origin: origin.toArray(), direction: direction.toArray() };
  }

  /** The surface as it is displayed now. */
  private current_(): Surface {
    const { tiles } = this.viewer;
    const { changes } = tiles;
    if (this.surface_?.changes !== changes) {
      this.surface_ = { changes, surface: new Surface(bounded(tiles.tiles(), this.welcome_!)) };
    }
    return this.surface_.surface;
  }

  private show_(place: Place, pose: Pose): void {
    this.last_ = { place, pose };
    this.moved(place);
    if (!this.tool_) return;
    this.tool_.setPose(pose.tip, pose.axis);
    this.tool_.group.visible = true;
    this.viewer.touchAll();
  }
}
