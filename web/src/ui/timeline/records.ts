// SPDX-License-Identifier: Apache-2.0
// The strokes, versions and forces of the journal. They are requested while the timeline is open, and
// only as often as something may have changed.

import { batch, computed, signal } from '@preact/signals';
import { forceCurve, listVersions } from '../../link/history';
import type { Version } from '../../link/history';
import type { ForceCurve } from '../../model/force_curve';
import { listStrokes } from '../../link/strokes';
import type { Stroke } from '../../model/stroke';
import { joined, mayHaveUndone, openSince, rowsOf } from '../../model/timeline';
import type { StrokeRow } from '../../model/timeline';
import type { StateMessage } from '../../wire/types';

const NEWER_MS = 1500;
/** Other viewers may name versions. */
const VERSIONS_MS = 15_000;
/** A state of the past does not say whether older strokes have been undone. */
const ALL_PAST_MS = 15_000;
/** An undo may be missed among the motions of other participants. */
const ALL_MS = 120_000;
const FORCE_POINTS = 800;
const FORCES_MS = 10_000;
/** Greatest share of the time that the server carves the journal again for the forces. */
const FORCES_SHARE = 0.05;

export class Records {
  private readonly strokes_ = signal<readonly Stroke[]>([]);
  private readonly rows_ = computed(() => rowsOf(this.strokes_.value));
  private readonly end_ = computed(() =>
    this.strokes_.value.reduce((end, { last }) => Math.max(end, last), 0),
  );
  private readonly forces_ = signal<ForceCurve | null>(null);
  private readonly versions_ = signal<readonly Version[]>([]);
  private busy_ = false;
  private askedMs_ = -Infinity;
  private allMs_ = -Infinity;
  private versionsMs_ = -Infinity;
  private present_: StateMessage | null = null; // as it was seen last
  private forcesMs_ = -Infinity;
  private forcesEnd_ = -1;
  private forcesBusy_ = false;

  constructor(
    private readonly session: string,
    private readonly failed: (problem: unknown) => void,
  ) {}

  // All are tracked as signals are.

  get strokes(): readonly Stroke[] {
    return this.strokes_.value;
  }

  /** The strokes by participants. */
  get rows(): readonly StrokeRow[] {
    return this.rows_.value;
  }

  /** The last record. */
  get end(): number {
    return this.end_.value;
  }

  /** Null until they have been requested. */
  get forces(): ForceCurve | null {
    return this.forces_.value;
  }

  /** The named versions. */
  get versions(): readonly Version[] {
    return this.versions_.value;
  }

  /** Everything is requested at the next tick. */
  invalidate(): void {
    this.allMs_ = -Infinity;
    this.versionsMs_ = -Infinity;
    this.askedMs_ = -Infinity;
  }

  /** Call often while the timeline is open, with the newest state. */
  tick(nowMs: number, state: StateMessage | null, mayReadForces: boolean): void {
    this.note_(state);
    if (!this.busy_ && nowMs - this.askedMs_ > NEWER_MS) void this.refresh_(nowMs);
    if (mayReadForces && !this.forcesBusy_ && nowMs >= this.forcesMs_) void this.refreshForces_();
  }

  private note_(state: StateMessage | null): void {
    const { present_: before } = this;
    this.present_ = state?.at ? null : state;
    if (before && this.present_ && mayHaveUndone(before, this.present_)) this.allMs_ = -Infinity;
    if (!before && this.present_) this.allMs_ = -Infinity; // it may have been in the past
  }

  private async refresh_(nowMs: number): Promise<void> {
    this.busy_ = true;
    this.askedMs_ = nowMs;
    const isAll = nowMs - this.allMs_ > (this.present_ ? ALL_MS : ALL_PAST_MS);
    const asksVersions = nowMs - this.versionsMs_ > VERSIONS_MS;
    const since = isAll ? 0 : openSince(this.rows);
    try {
      const [strokes, versions] = await Promise.all([
        listStrokes(this.session, since),
        asksVersions ? listVersions(this.session) : this.versions,
      ]);
      const isLatest = this.askedMs_ === nowMs; // nothing was invalidated meanwhile
      if (isAll && isLatest) this.allMs_ = nowMs;
      if (asksVersions && isLatest) this.versionsMs_ = nowMs;
      batch(() => {
        this.strokes_.value = joined(this.strokes, since, strokes);
        this.versions_.value = versions;
      });
    } catch (problem) {
      this.failed(problem);
    }
    this.busy_ = false;
  }

  private async refreshForces_(): Promise<void> {
    if (this.end === this.forcesEnd_) return;
    this.forcesBusy_ = true;
    this.forcesEnd_ = this.end;
    const beganMs = performance.now();
    try {
      this.forces_.value = await forceCurve(this.session, FORCE_POINTS);
    } catch (problem) {
      this.failed(problem);
    }
    const endMs = performance.now();
    this.forcesMs_ = endMs + Math.max(FORCES_MS, (endMs - beganMs) / FORCES_SHARE);
    this.forcesBusy_ = false;
  }
}
