// SPDX-License-Identifier: Apache-2.0
// Turns the poses of a pointer into timed samples that the server accepts: with increasing times, at
// most so many per second, and no faster than a tip may move. A jump is divided and takes its time.

import { BUTTON_CUTTING, BUTTON_DEADMAN } from '../wire/types';
import type { Vec3 } from '../wire/types';
import type { Draft } from './sample_log';
import { distance } from '../model/vector';
import { PathQueue } from './tool/path_queue';
import type { PathRequest, Pose, Waiting } from './tool/path_queue';
import { lerp, slerp } from './tool/vectors';

export interface SamplerLimits {
  speedMmPerS: number;
  samplesPerS: number;
}

const OF_LIMIT = 0.8; // rounding, and clocks that differ a little
const HAND_MM_PER_S = 1000; // faster sweeps follow later
const BURST_S = 0.1; // unused time that may be made up for
const GRID_PER_MM = 1e6; // the server rounds poses to six decimals

function onGrid(tip: Vec3): Vec3 {
  return tip.map((value) => Math.round(value * GRID_PER_MM) / GRID_PER_MM) as Vec3;
}

export class Sampler {
  private readonly queue_ = new PathQueue();
  private at_: Waiting | null = null; // the newest sample
  private atUs_ = 0;
  private speed_ = HAND_MM_PER_S;
  private ratePerUs_ = 1e-3;

  constructor(private tool_: number) {}

  set limits({ speedMmPerS, samplesPerS }: SamplerLimits) {
    this.speed_ = Math.min(HAND_MM_PER_S, OF_LIMIT * speedMmPerS);
    this.ratePerUs_ = (OF_LIMIT * samplesPerS) / 1e6;
  }

  /** The tool of the poses from now on. Waiting poses keep the tool that they were pushed with. */
  set tool(id: number) {
    this.tool_ = id;
  }

  /** Where the tool goes next; `cuts`: on its path there. */
  push({ tip, axis }: Pose, cuts: boolean): void {
    this.queue_.push({ pose: { tip: onGrid(tip), axis }, cuts, tool: this.tool_ });
  }

  /** Asks the server, after all that waits. */
  ask(request: PathRequest): void {
    this.queue_.ask(request);
  }

  /** Undoes the newest stroke. Returns whether it had only waited: else the server is asked. */
  undo(): boolean {
    return this.queue_.undo(this.at_);
  }

  /** Redoes the stroke that was undone last. Returns whether it waits again: else as undo(). */
  redo(): boolean {
    return this.queue_.redo();
  }

  /** Drops the waiting poses and the tool's position: the next pose is reached without a motion. */
  forget(): void {
    this.queue_.clear();
    this.at_ = null;
  }

  /** How many poses and requests wait. */
  get waiting(): number {
    return this.queue_.size;
  }

  /** The requests after the samples that were taken. Send them before taking more. */
  takeRequests(): PathRequest[] {
    return this.queue_.takeRequests();
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
    const length = steps.at(-1)!.reached || 1;
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
      const length = distance(from.tip, next.pose.tip);
      if (reached + length <= reachMm || !next.cuts) {
        this.queue_.shift();
        if (next.cuts) reached += length;
        steps.push({ waiting: next, reached });
        from = next.pose;
        continue;
      }
      const part = (reachMm - reached) / length;
      const pose = {
        tip: onGrid(lerp(from.tip, next.pose.tip, part)),
        axis: slerp(from.axis, next.pose.axis, part),
      };
      steps.push({ waiting: { pose, cuts: true, tool }, reached: reachMm });
      break;
    }
    return steps;
  }

  private sample_(waiting: Waiting, timeUs: number): Draft {
    const time = Math.max(timeUs, this.atUs_ + 1);
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
