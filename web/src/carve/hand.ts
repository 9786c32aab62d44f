// SPDX-License-Identifier: Apache-2.0
// The tool in the hand: where the pointer puts it, how it is drawn, and the samples of its path.

import { t } from '../strings';
import { stockBounds } from '../model/session';
import { toolProfile } from '../model/tool_profile';
import { GhostTool } from '../view/ghost_tool';
import type { Viewer } from '../view/viewer';
import type { ToolInfo, Welcome } from '../wire/types';
import { Aim } from './aim';
import type { AimSettings, Sight } from './aim';
import { Drag } from './drag';
import type { DragStep } from './drag';
import type { Pose } from './tool/path_queue';
import { Images } from './images';
import type { Mirror } from './mirror';
import { between, PointerPath } from './pointer_path';
import type { Place } from './place';
import { Sampler } from './sampler';
import { Steady } from './steady';
import { Surface } from './surface';

const RESTS_MS = 40; // a pointer from which nothing comes for so long
const NEAR_PX = 0.5; // places this near are not divided
const GAP_DIAMETERS = 2; // between near places of the picture: the tool goes through the air
const OUT_OF_REACH = t(
  "A vertical tool can't reach this spot. Choose Axis: surface (L), or carve from another side.",
);

interface Stroke {
  surface: Surface;
  path: PointerPath;
  movedMs: number;
  /** The newest place of its path. */
  at: Place;
}

export class Hand {
  readonly settings: AimSettings = { mode: 'surface', depthMm: 1, axis: 'surface' };
  /** Its path, as the server gets it. */
  readonly sampler = new Sampler(0);
  /** By which it follows the pointer in a stroke. */
  readonly drag = new Drag();
  /** By which the pointer leads it in a stroke. */
  readonly steady = new Steady();
  private aim_: Aim | null = null;
  private tool_: GhostTool | null = null;
  private readonly images_: Images;
  private surface_: { changes: number; surface: Surface } | null = null;
  /** While it lasts: the surface as it was when it began. */
  private stroke_: Stroke | null = null;
  private last_: { place: Place; pose: Pose } | null = null;
  private drawn_: Pose | null = null;
  /** Of a device that is no pointer: where the tool is, and whether it cuts. */
  private free_: Pose | null = null;
  private freelyCuts_ = false;
  /** While the plane is held for one stroke. */
  private modeBefore_: AimSettings['mode'] | null = null;

  /** `moved`: the tool is drawn at a place, or nowhere. */
  constructor(
    private readonly viewer: Viewer,
    private readonly moved: (place: Place | null) => void,
  ) {
    this.images_ = new Images(viewer);
  }

  /** The symmetry of its strokes. A stroke must have ended. */
  get mirror(): Mirror {
    return this.images_.mirror;
  }

  set mirror(mirror: Mirror) {
    this.images_.mirror = mirror;
    this.sampler.images = this.images_.images;
  }

  /** Whether the plane or the axis of the symmetry is shown. */
  set showsMirror(shows: boolean) {
    this.images_.isShown = shows;
  }

  /** Takes a tool of the session. A stroke must have ended; it is sent with its own tool. */
  takeTool(tool: ToolInfo, color: string, welcome: Welcome): void {
    this.aim_ = new Aim(toolProfile(tool), stockBounds(welcome.stock), this.settings);
    this.sampler.tool = tool.id;
    this.hide();
    this.tool_?.dispose();
    this.tool_ = new GhostTool(tool, color, false);
    this.viewer.stage.scene.add(this.tool_.group);
    this.images_.takeTool(tool, color, welcome);
    this.sampler.images = this.images_.images;
  }

  get isCutting(): boolean {
    return this.stroke_ !== null || this.freelyCuts_;
  }

  /** Whether it cuts with its axis more than 45° from the vertical. */
  get isOnSide(): boolean {
    return this.isCutting && this.drawn_ !== null && this.drawn_.axis[2] < Math.SQRT1_2;
  }

  /** Shows where the tool would cut; `isSent`: others see it too. */
  hover(place: Place | null, isSent: boolean): void {
    if (this.stroke_) return; // of another pointer: the stroke goes on
    const pose = place && this.aim_?.hover(this.current_(), this.ray_(place));
    if (!place || !pose) {
      this.hide();
      return;
    }
    this.show_(place, pose);
    if (isSent) this.sampler.push(this.aim_!.lifted(pose), false);
  }

  /** Shows it again where it is, after a change of the settings. */
  hoverAgain(isSent: boolean): void {
    if (this.last_) this.hover(this.last_.place, isSent);
  }

  /** Begins a stroke; returns why there is none, as a sentence for the user, or nothing. */
  begin(place: Place, depthMm: number): string {
    const surface = this.current_();
    const ray = this.ray_(place);
    this.press_(place, depthMm);
    const pose = this.aim_?.begin(surface, ray);
    if (!this.aim_ || !pose) return surface.hit(ray) ? OUT_OF_REACH : '';
    const now = performance.now();
    this.stroke_ = { surface, path: new PointerPath(place), movedMs: now, at: place };
    this.drag.begin({ place, pose }, now);
    this.steady.begin(place);
    this.sampler.push(this.aim_.lifted(pose), false);
    this.cutTo_({ place, pose });
    return '';
  }

  /** From here to its end the stroke stays on the plane on which it has begun. */
  holdPlane(): void {
    this.modeBefore_ ??= this.settings.mode;
    this.settings.mode = 'plane';
  }

  /**
   * Continues the stroke; unless it is dragged, the tool is drawn at the newest place, ahead of the cut
   * by half a step.
   */
  move(places: readonly Place[], depthMm: number): void {
    const { stroke_: stroke, aim_: aim } = this;
    if (!stroke || !aim) return;
    const led = this.steady.follow(places);
    const newest = led.at(-1);
    if (!newest) return;
    for (const place of led) this.follow_(stroke.path.to(place), depthMm);
    stroke.movedMs = performance.now();
    if (!this.keepUp_()) return;
    const pose = aim.peek(stroke.surface, this.ray_(newest));
    if (pose) this.show_(newest, pose);
  }

  /** Cuts up to a pointer that rests. */
  settle(depthMm: number, nowMs: number): void {
    const { stroke_: stroke } = this;
    if (!stroke || nowMs - stroke.movedMs <= RESTS_MS) return;
    this.follow_(stroke.path.end(), depthMm);
    this.keepUp_();
  }

  /** Moves the tool on, as far as the force lets it: `share` of the one that fills the ring. */
  pull(share: number, nowMs: number): void {
    if (this.stroke_) this.goOn_(this.drag.follow(share, nowMs));
  }

  /** Between the tool and the pointer that leads it; null: it is at the pointer. */
  get stretch(): readonly [Place, Place] | null {
    const [lag, string] = [this.drag.stretch, this.steady.stretch];
    return lag && string ? [lag[0], string[1]] : (lag ?? string);
  }

  /** Lifts the tool, at the pointer or where its string leads it. */
  end(depthMm: number): void {
    if (this.stroke_) this.follow_(this.stroke_.path.end(), depthMm);
    this.goOn_(this.drag.end());
    if (this.stroke_ && this.aim_ && this.last_) {
      this.sampler.push(this.aim_.lifted(this.last_.pose), false);
    }
    this.sampler.endGesture();
    this.steady.end();
    this.stroke_ = null;
    this.aim_?.end();
    this.settings.mode = this.modeBefore_ ?? this.settings.mode;
    this.modeBefore_ = null;
  }

  /** Moves the tool of a device that is no pointer; `cuts`: on its path there. */
  moveTo(pose: Pose, cuts: boolean, isSent: boolean): void {
    if (this.stroke_) return; // of a pointer: it goes on
    this.draw_(pose);
    if (!isSent) return;
    // A stroke begins where the tool was.
    if (cuts && !this.freelyCuts_) this.sampler.push(this.free_ ?? pose, false);
    this.sampler.push(pose, cuts);
    if (!cuts) this.sampler.endGesture();
    this.freelyCuts_ = cuts;
    this.free_ = pose;
  }

  /** Ends the stroke of such a device where the tool is. */
  lift(): void {
    if (this.freelyCuts_ && this.free_) this.sampler.push(this.free_, false);
    this.sampler.endGesture();
    this.freelyCuts_ = false;
    this.free_ = null;
  }

  /** Where the tool is drawn; null: nowhere. */
  get pose(): Pose | null {
    return this.tool_?.group.visible ? this.drawn_ : null;
  }

  hide(): void {
    this.last_ = null;
    this.moved(null);
    if (!this.tool_?.group.visible) return;
    this.tool_.group.visible = false;
    this.images_.hide();
    this.viewer.touchAll();
  }

  /** Nobody carves: hides it, and lets the surface go. */
  rest(): void {
    this.lift();
    this.hide();
    this.showsMirror = false;
    this.surface_ = null;
    this.viewer.displayed.forget();
  }

  private follow_(places: readonly Place[], depthMm: number): void {
    for (const place of places) this.step_(place, depthMm);
  }

  /** Goes to a place, by the places between where the surface there is far from the tool. */
  private step_(place: Place, depthMm: number): void {
    const { stroke_: stroke, aim_: aim } = this;
    if (!stroke || !aim) return;
    const { surface, at } = stroke;
    const ray = this.ray_(place);
    const farMm = aim.farTo(surface, ray);
    const px = Math.hypot(place.x - at.x, place.y - at.y);
    if (farMm > aim.radiusMm && px > NEAR_PX) {
      this.step_(between(at, place, 0.5), depthMm);
      this.step_(place, depthMm);
      return;
    }
    const hops = farMm > 2 * GAP_DIAMETERS * aim.radiusMm;
    this.press_(place, depthMm);
    const pose = aim.move(surface, ray);
    stroke.at = place;
    if (!pose) return;
    this.drag.pull({ place, pose, ...(hops && { hop: aim.lifted(pose) }) });
  }

  /** Unless it is held back, the tool is where the pointer is. */
  private keepUp_(): boolean {
    if (!this.drag.isSlow) this.goOn_(this.drag.end());
    return !this.drag.isSlow;
  }

  private goOn_(steps: readonly DragStep[]): void {
    for (const step of steps) this.cutTo_(step);
  }

  private cutTo_({ place, pose, hop }: DragStep): void {
    this.show_(place, pose);
    if (hop) this.sampler.push(hop, false);
    this.sampler.push(pose, true);
  }

  /** A pen that is pressed lightly cuts less deep. */
  private press_({ pressure }: Place, depthMm: number): void {
    this.settings.depthMm = depthMm * (pressure ?? 1);
  }

  private ray_({ x, y, tilt }: Place): Sight {
    const { origin, direction } = this.viewer.ray(x, y);
    const pen = tilt && this.viewer.upright(...tilt).toArray();
    return { origin: origin.toArray(), direction: direction.toArray(), pen };
  }

  /** The surface as it is displayed now. */
  private current_(): Surface {
    const { displayed } = this.viewer;
    const { changes } = displayed;
    if (this.surface_?.changes !== changes) {
      this.surface_ = { changes, surface: new Surface(displayed.pieces) };
    }
    return this.surface_.surface;
  }

  private show_(place: Place, pose: Pose): void {
    this.last_ = { place, pose };
    this.moved(place);
    this.draw_(pose);
  }

  private draw_(pose: Pose): void {
    this.drawn_ = pose;
    if (!this.tool_) return;
    this.tool_.setPose(pose.tip, pose.axis);
    this.tool_.group.visible = true;
    this.tool_.meets = this.last_ !== null && this.aim_?.touches === true;
    this.images_.place(pose);
    this.viewer.touchAll();
  }
}
