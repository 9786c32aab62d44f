// SPDX-License-Identifier: Apache-2.0
// The queue of poses of the tool's path, with the requests between them, in the order of sending.
// Strokes of which nothing is sent yet are undone and redone here, all others by the server.

import type { AgentHello, AgentRequest } from '../../wire/agent_control';
import type { Vec3 } from '../../wire/types';

export interface Pose {
  tip: Vec3;
  /** From the tip to the spindle, unit length. */
  axis: Vec3;
}

/** The pose of the same tool in a mirror, or turned. */
export type Image = (pose: Pose) => Pose;

export interface Waiting {
  pose: Pose;
  /** On the path there. */
  cuts: boolean;
  tool: number;
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

export type PathRequest = Exclude<AgentRequest, AgentHello | { type: 'stock' }>;
type Item = Waiting | PathRequest | Repeat;

function isPose(item: Item | null | undefined): item is Waiting {
  return item !== null && item !== undefined && !('type' in item);
}

function cutsAt(item: Item | undefined): boolean {
  return isPose(item) && item.cuts;
}

export class PathQueue {
  private items_: Item[] = [];
  /** Strokes that were undone, the last one last, with the poses around them; null: by the server. */
  private undone_: (Waiting[] | null)[] = [];

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

  /** Removes and returns the requests before the next pose or repeat. */
  takeRequests(): PathRequest[] {
    const end = this.items_.findIndex((item) => isPose(item) || item.type === 'repeat');
    return this.items_.splice(0, end < 0 ? this.items_.length : end) as PathRequest[];
  }

  /** Removes a repeat that comes next. */
  takeRepeat(): Repeat | null {
    const [first] = this.items_;
    if (!first || isPose(first) || first.type !== 'repeat') return null;
    this.items_.shift();
    return first;
  }

  /** Puts poses before all others. */
  putFirst(poses: readonly Waiting[]): void {
    this.items_.unshift(...poses);
  }

  push(pose: Waiting): void {
    if (pose.cuts) this.undone_ = [];
    this.put_(pose);
  }

  ask(request: PathRequest | Repeat): void {
    const last = this.items_.at(-1);
    const isReplaced = request.type === 'tool' && last && !isPose(last) && last.type === 'tool';
    if (isReplaced) this.items_.pop();
    this.items_.push(request);
  }

  /** Undoes the newest stroke; `at`: the newest sample. Returns whether it was undone here. */
  undo(at: Waiting | null): boolean {
    const stroke = this.takeNewest_(at);
    this.undone_.push(stroke);
    if (!stroke) this.ask({ type: 'undo' });
    return stroke !== null;
  }

  /** Redoes the last undone stroke. Returns whether that was undone here. */
  redo(): boolean {
    const stroke = this.undone_.pop() ?? null;
    for (const pose of stroke ?? []) this.put_(pose);
    if (!stroke) this.ask({ type: 'redo' });
    return stroke !== null;
  }

  clear(): void {
    this.items_ = [];
    this.undone_ = [];
  }

  private put_(pose: Waiting): void {
    const last = this.items_.at(-1);
    // Through the air only the newest place counts, and where a tool was before it was changed.
    const isPassed = isPose(last) && !last.cuts && !pose.cuts && last.tool === pose.tool;
    if (isPassed) this.items_.pop();
    this.items_.push(pose);
  }

  /** Takes out the newest stroke; null: a part of it is sent, or a request follows it. */
  private takeNewest_(at: Waiting | null): Waiting[] | null {
    const items = this.items_;
    let last = items.length - 1;
    while (isPose(items[last]) && !cutsAt(items[last])) --last;
    if (!cutsAt(items[last])) return null;
    let first = last;
    while (cutsAt(items[first - 1])) --first;
    const before = first > 0 ? items[first - 1] : at;
    if (!isPose(before) || before.cuts) return null;
    const after = items.slice(last + 1) as Waiting[];
    const stroke = items.slice(first, last + 1) as Waiting[];
    this.items_ = items.slice(0, first);
    for (const pose of after) this.put_(pose);
    return [before, ...stroke, ...after];
  }
}
