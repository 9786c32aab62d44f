// SPDX-License-Identifier: Apache-2.0
// Turns the poses of a pointer into timed samples that the server accepts: with increasing times, at
// most so many per second, and no faster than a tip may move. A jump is divided and takes its time,
// and so does a turn of the axis.
//
// A gesture begins when the user touches down and ends when the user lifts. It consists of one stroke,
// or of several if the surface has gaps, and of their images. One undo takes all of it back that the
// block has. Images repeat the samples that were sent, so that the kernel divides mirrored motions in the same way.

import { BUTTON_CUTTING, BUTTON_DEADMAN } from '../wire/types';
import type { Vec3 } from '../wire/types';
import type { Draft } from './sample_log';
import { distance } from '../model/vector';
import { Gestures, ONE_EACH } from './gestures';
import type { Count, KeptGestures } from './gestures';
import { PathQueue } from './tool/path_queue';
import type { Change, Gesture, Image, Pose, Repeat, ToolRequest, Waiting } from './tool/path_queue';
import { angleBetween, lerp, slerp } from './tool/vectors';

export interface SamplerLimits {
  speedMmPerS: number;
  samplesPerS: number;
}

/** The newest `strokes` of the block are undone, or so many redone: all of a gesture. */
export interface ChangeRequest {
  type: 'change';
  undone: boolean;
  strokes: number;
  /** To be called if nothing has changed. */
  failed: () => void;
}
export type PathRequest = ToolRequest | ChangeRequest;

const OF_LIMIT = 0.8; // rounding, and clocks that differ a little
const HAND_MM_PER_S = 1000; // faster sweeps follow later
const BURST_S = 0.1; // unused time that may be made up for
/**
 * A turn takes as long as a place this far above the tip would take on a straight line, mm. With the
 * greatest speed and burst a motion turns by 2.5 rad at most; the kernel takes 170°.
 */
const ARM_MM = 40;
const GRID_PER_MM = 1e6; // the server rounds poses to six decimals

/** The length of a motion that counts for its duration, mm. */
function lengthOf(from: Pose, to: Pose): number {
  return Math.max(distance(from.tip, to.tip), ARM_MM * angleBetween(from.axis, to.axis));
}

function onGrid(tip: Vec3): Vec3 {
  return tip.map((value) => Math.round(value * GRID_PER_MM) / GRID_PER_MM) as Vec3;
}

export class Sampler {
  private readonly queue_ = new PathQueue();
  private at_: Waiting | null = null; // the newest sample
  private atUs_ = 0;
  private speed_ = HAND_MM_PER_S;
  private ratePerUs_ = 1e-3;
  private images_: readonly Image[] = [];
  /** The strokes that images will repeat, as they were sent, with the poses before and after them. */
  private recorded_: Waiting[][] = [];
  private strokes_ = 0; // of the present gesture
  private isDown_ = false;
  private gesture_: Gesture | null = null; // the present one, once it has a stroke
  private readonly gestures_ = new Gestures();
  /** Of each undone gesture: the strokes that had only waited, and whether the block has others. */
  private undone_: { waiting: Waiting[][]; isAsked: boolean }[] = [];

  constructor(private tool_: number) {}

  set limits({ speedMmPerS, samplesPerS }: SamplerLimits) {
    this.speed_ = Math.min(HAND_MM_PER_S, OF_LIMIT * speedMmPerS);
    this.ratePerUs_ = (OF_LIMIT * samplesPerS) / 1e6;
  }

  /** The tool of the poses from now on. Waiting poses keep the tool that they were pushed with. */
  set tool(id: number) {
    this.tool_ = id;
  }

  /** By which the gestures from now on are repeated. The one before must have ended. */
  set images(images: readonly Image[]) {
    this.images_ = images;
  }

  /** Where the tool goes next; `cuts`: on its path there. */
  push({ tip, axis }: Pose, cuts: boolean): void {
    if (cuts && !this.isDown_) this.strokes_ += 1;
    if (cuts) {
      this.undone_ = [];
      this.gesture_ ??= { sent: null, known: null };
    }
    this.isDown_ = cuts;
    const isRepeated = this.images_.length > 0 && this.strokes_ > 0;
    const pose = { tip: onGrid(tip), axis };
    this.queue_.push({
      ...{ pose, cuts, tool: this.tool_ },
      ...(this.gesture_ && { gesture: this.gesture_ }),
      ...(isRepeated && { isRepeated }),
    });
  }

  /** Ends a gesture, after the tool was lifted: its images follow. */
  endGesture(): void {
    const { strokes_: strokes, images_: images } = this;
    if (strokes === 0) return;
    this.strokes_ = 0;
    this.gesture_ = null;
    if (images.length > 0) this.queue_.ask({ type: 'repeat', strokes, images });
  }

  /** Asks the server, after all that waits. */
  ask(request: ToolRequest): void {
    this.queue_.ask(request);
  }

  /** Undoes the newest gesture. Returns whether it had only waited: else the block is asked. */
  undo(): boolean {
    this.endGesture();
    const gesture = this.queue_.newestGesture;
    const waiting: Waiting[][] = [];
    for (let more = gesture !== null; more;) {
      const stroke = this.queue_.takeNewest(this.at_, gesture!);
      more = stroke !== null;
      if (stroke) waiting.push(stroke);
    }
    const isWhole = waiting.length > 0 && gesture?.sent === null;
    this.undone_.push({ waiting, isAsked: !isWhole });
    const only = waiting.length > 0 ? gesture : null;
    if (!isWhole) this.queue_.ask({ type: 'change', undone: true, gesture: only });
    return isWhole;
  }

  /** Redoes the gesture that was undone last. Returns whether it waits again: else as undo(). */
  redo(): boolean {
    const { waiting, isAsked } = this.undone_.pop() ?? { waiting: [], isAsked: true };
    if (isAsked) this.queue_.ask({ type: 'change', undone: false, gesture: null });
    for (const pose of waiting.reverse().flat()) this.queue_.push(pose);
    return !isAsked;
  }

  /** The gestures of a page that is left, for the next one. */
  keep(count: Count): KeptGestures {
    return this.gestures_.keep(count);
  }

  restore(kept: KeptGestures): void {
    this.gestures_.restore(kept);
  }

  /** Drops the waiting poses and the tool's position: the next pose is reached without a motion. */
  forget(): void {
    this.queue_.clear();
    this.at_ = null;
    this.recorded_ = [];
    this.strokes_ = 0;
    this.gesture_ = null;
    this.isDown_ = false;
  }

  /** How many poses and requests wait. */
  get waiting(): number {
    return this.queue_.size;
  }

  /**
   * The requests after the samples that were taken. Send them before taking more. A gesture is undone
   * once `count` knows which of its strokes the block has.
   */
  takeRequests(count: Count = ONE_EACH): PathRequest[] {
    const requests: PathRequest[] = [];
    for (;;) {
      const request = this.queue_.takeRequest('tool') ?? this.queue_.takeRequest('change');
      if (!request) break;
      const isTaken = request.type === 'tool' || this.resolve_(request, count, requests);
      if (request.type === 'tool') requests.push(request);
      if (!isTaken) return requests;
    }
    const repeat = this.queue_.takeRequest('repeat');
    if (repeat) this.repeat_(repeat);
    return requests;
  }

  /** Returns false if it waits again. */
  private resolve_(change: Change, count: Count, requests: PathRequest[]): boolean {
    const { undone, gesture } = change;
    const strokes = undone ? this.gestures_.undo(count, gesture) : this.gestures_.redo();
    if (strokes === null) this.queue_.putBack(change);
    if (strokes === null || strokes === 0) return strokes === 0;
    const failed = (): void => this.gestures_.takeBack(undone);
    requests.push({ type: 'change', undone, strokes, failed });
    return true;
  }

  /**
   * Returns the samples that are due, up to the next request. A tool that is held in the cut is sent at rest, so that its
   * next motion does not seem to have lasted since the last one.
   */
  take(nowUs: number): Draft[] {
    const sinceUs = Math.min(nowUs - this.atUs_, BURST_S * 1e6);
    const count = Math.floor(sinceUs * this.ratePerUs_);
    if (count < 1) return [];
    if (!this.at_) return this.place_(nowUs);
    if (!this.queue_.next) return this.at_.cuts ? [this.sample_(this.at_, nowUs)] : [];
    const startUs = nowUs - sinceUs;
    const steps = this.walk_(count, (this.speed_ * sinceUs) / 1e6);
    const length = (steps.at(-1)?.reached ?? 0) || 1;
    return steps.map(({ waiting, reached }, n) => {
      // Even a step of no length takes its share of the time.
      const part = (0.999 * reached) / length + (0.001 * (n + 1)) / steps.length;
      return this.sample_(waiting, Math.round(startUs + part * (nowUs - startUs)));
    });
  }

  private place_(nowUs: number): Draft[] {
    const first = this.queue_.shift();
    return first ? [this.sample_({ ...first, cuts: false }, nowUs)] : [];
  }

  /** Takes up to `count` poses within `reachMm` along the path, and divides the one beyond. */
  private walk_(count: number, reachMm: number): { waiting: Waiting; reached: number }[] {
    const steps: { waiting: Waiting; reached: number }[] = [];
    let from = this.at_!.pose;
    let { tool } = this.at_!;
    let reached = 0;
    while (steps.length < count) {
      const { next } = this.queue_;
      if (!next) break;
      if (next.tool !== tool) {
        // Another tool begins at its first place.
        this.queue_.shift();
        steps.push({ waiting: { ...next, cuts: false }, reached });
        ({ pose: from, tool } = next);
        continue;
      }
      const length = lengthOf(from, next.pose);
      if (reached + length <= reachMm || !next.cuts) {
        this.queue_.shift();
        if (next.cuts) reached += length;
        steps.push({ waiting: next, reached });
        from = next.pose;
        continue;
      }
      // An image waits for its time. It needs no more than a burst, unless the limits have changed.
      if (next.isImage && reachMm < this.speed_ * BURST_S) break;
      const part = (reachMm - reached) / length;
      const pose = {
        tip: onGrid(lerp(from.tip, next.pose.tip, part)),
        axis: slerp(from.axis, next.pose.axis, part),
      };
      steps.push({ waiting: { ...next, pose, tool }, reached: reachMm });
      break;
    }
    return steps;
  }

  private record_(before: Waiting, waiting: Waiting): void {
    if (waiting.cuts && !before.cuts) this.recorded_.push([before]);
    const isRest = lengthOf(before.pose, waiting.pose) === 0 && before.cuts === waiting.cuts;
    if ((before.cuts || waiting.cuts) && !isRest) this.recorded_.at(-1)?.push(waiting);
  }

  private repeat_({ strokes, images }: Repeat): void {
    const recorded = this.recorded_.slice(-strokes);
    this.recorded_ = [];
    const repeated = images.flatMap((image) =>
      recorded.flatMap((stroke) =>
        stroke.map(({ pose, cuts, tool }, n): Waiting => {
          const { gesture } = stroke.at(-1)!;
          const { tip, axis } = image(pose);
          const isCut = cuts && n > 0;
          return {
            ...{ pose: { tip: onGrid(tip), axis }, cuts: isCut, tool, isImage: true },
            ...(gesture && { gesture }),
          };
        }),
      ),
    );
    this.queue_.putFirst(repeated);
  }

  private sample_(waiting: Waiting, timeUs: number): Draft {
    const time = Math.max(timeUs, this.atUs_ + 1);
    if (waiting.isRepeated && this.at_) this.record_(this.at_, waiting);
    if (waiting.cuts && !this.at_?.cuts) this.gestures_.strokeOf(waiting.gesture);
    this.at_ = waiting;
    this.atUs_ = time;
    return {
      time_us: BigInt(time),
      tip_mm: waiting.pose.tip,
      axis: waiting.pose.axis,
      tool_id: waiting.tool,
      buttons: waiting.cuts ? BUTTON_CUTTING | BUTTON_DEADMAN : 0,
      felt_share: 0,
    };
  }
}
