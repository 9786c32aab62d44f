// SPDX-License-Identifier: Apache-2.0
// The queue of poses of the tool's path, with the requests between them, in the order of sending.
// Strokes of which nothing is sent yet can be taken out; all others the server undoes.

import type { AgentRequest } from '../../wire/agent_control';
import type { Vec3 } from '../../wire/types';

export interface Pose {
  tip: Vec3;
  /** From the tip to the spindle, unit length. */
  axis: Vec3;
}

/** The pose of the same tool in a mirror, or turned. */
export type Image = (pose: Pose) => Pose;

export interface Gesture {
  /** Its strokes that were sent, from one number to another; null: none was. */
  sent: { from: number; to: number } | null;
  /** Of one of an earlier page, or of before: how many strokes it had. */
  known: number | null;
}

export interface Waiting {
  pose: Pose;
  /** On the path there. */
  cuts: boolean;
  tool: number;
  /** Of a stroke, and of its images. */
  gesture?: Gesture;
  /** Its motion is repeated in images: it is recorded, as it is sent. */
  isRepeated?: boolean;
  /** Its motion is an image, which is not divided. */
  isImage?: boolean;
}

/** The newest `strokes` that were recorded are repeated by each image. */
export interface Repeat {
  type: 'repeat';
  strokes: number;
  images: readonly Image[];
}

/** A gesture is undone, or redone: the newest one if none is named. */
export interface Change {
  type: 'change';
  undone: boolean;
  gesture: Gesture | null;
}

export type ToolRequest = Extract<AgentRequest, { type: 'tool' }>;
type Item = Waiting | ToolRequest | Change | Repeat;

function isPose(item: Item | null | undefined): item is Waiting {
  return item !== null && item !== undefined && !('type' in item);
}

function cutsAt(item: Item | undefined): boolean {
  return isPose(item) && item.cuts;
}

export class PathQueue {
  private items_: Item[] = [];

  /** Poses and requests. */
  get size(): number {
    return this.items_.length;
  }

  /** The next pose; null: there is none, or a request comes first. */
  get next(): Waiting | null {
    const [first] = this.items_;
    return isPose(first) ? first : null;
  }

  /** Removes the next pose. */
  shift(): Waiting | null {
    return this.next && (this.items_.shift() as Waiting);
  }

  /** Removes a request that comes next, of this type. */
  takeRequest<Type extends 'tool' | 'change' | 'repeat'>(
    type: Type,
  ): Extract<Item, { type: Type }> | null {
    const [first] = this.items_;
    if (!first || isPose(first) || first.type !== type) return null;
    this.items_.shift();
    return first as Extract<Item, { type: Type }>;
  }

  /** Puts a request back that was taken. */
  putBack(request: Change): void {
    this.items_.unshift(request);
  }

  /** Puts poses before all others. */
  putFirst(poses: readonly Waiting[]): void {
    this.items_.unshift(...poses);
  }

  push(pose: Waiting): void {
    const last = this.items_.at(-1);
    // Through the air only the newest place counts, and where a tool was before it was changed.
    const isPassed = isPose(last) && !last.cuts && !pose.cuts && last.tool === pose.tool;
    if (isPassed) this.items_.pop();
    this.items_.push(pose);
  }

  ask(request: ToolRequest | Change | Repeat): void {
    const last = this.items_.at(-1);
    const isReplaced = request.type === 'tool' && last && !isPose(last) && last.type === 'tool';
    if (isReplaced) this.items_.pop();
    this.items_.push(request);
  }

  /** That of the newest stroke; null: a request follows it. */
  get newestGesture(): Gesture | null {
    const last = this.items_[this.newestCut_()];
    return isPose(last) && last.cuts ? (last.gesture ?? null) : null;
  }

  clear(): void {
    this.items_ = [];
  }

  /**
   * Takes out the newest stroke, with the poses around it; `at`: the newest sample. Null: it is none
   * of this gesture, a part of it is sent, or a request follows it.
   */
  takeNewest(at: Waiting | null, gesture: Gesture): Waiting[] | null {
    const items = this.items_;
    const last = this.newestCut_();
    const newest = items[last];
    if (!isPose(newest) || !newest.cuts || newest.gesture !== gesture) return null;
    let first = last;
    while (cutsAt(items[first - 1])) --first;
    const before = first > 0 ? items[first - 1] : at;
    if (!isPose(before) || before.cuts) return null;
    const after = items.slice(last + 1) as Waiting[];
    const stroke = items.slice(first, last + 1) as Waiting[];
    this.items_ = items.slice(0, first);
    for (const pose of after) this.push(pose);
    return [before, ...stroke, ...after];
  }

  /** The index of the newest pose that cuts, or of a request after it; -1: there is neither. */
  private newestCut_(): number {
    let last = this.items_.length - 1;
    while (isPose(this.items_[last]) && !cutsAt(this.items_[last])) last -= 1;
    return last;
  }
}
