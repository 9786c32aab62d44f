// SPDX-License-Identifier: Apache-2.0
// The NC programs of the session, as the server pushes them and answers requests.

import { signal } from '@preact/signals';
import type { ProgramInfo } from '../wire/types';

const NC = 'nc ngc cnc tap gcode txt eia iso din min gc g mpf spf h hnc fnc nct ncc ptp pim anc';
const OTHERS = 'pgm prg apt aptsource cl cld cldata cls ncl';
/** Of the names of NC and APT programs, as server/formats reads them. */
export const PROGRAM_ENDINGS: readonly string[] = `${NC} ${OTHERS}`
  .split(' ')
  .map((ending) => `.${ending}`);

export function isOpen(program: ProgramInfo): boolean {
  return program.state === 'queued' || program.state === 'running' || program.state === 'paused';
}

/** Seconds until the program ends, by the clock; NaN at the pace `fast`, which has no time. */
export function wallSeconds(program: ProgramInfo): number {
  if (program.pace === 'fast') return Number.NaN;
  return program.remaining_s / (program.speed ?? 1);
}

/** The readers are tracked in components and effects: the list is the value of a signal. */
export class Programs {
  private readonly known_ = signal<ReadonlyMap<number, ProgramInfo>>(new Map());
  private readonly incomplete_ = signal(false);

  /** A program has ended and was not among those that were pushed: request the list. */
  get incomplete(): boolean {
    return this.incomplete_.value;
  }

  /** The list is being requested. */
  requested(): void {
    this.incomplete_.value = false;
  }

  clear(): void {
    this.known_.value = new Map();
    this.incomplete_.value = false;
  }

  /** Applies a message of the server: all programs that have not ended, and some that have. */
  apply(pushed: readonly ProgramInfo[]): void {
    const listed = new Set(pushed.map((program) => program.id));
    const known = [...this.known_.peek().values()];
    const missing = known.filter((program) => isOpen(program) && !listed.has(program.id));
    this.put_(
      known.filter((program) => !missing.includes(program)),
      pushed,
    );
    if (missing.length > 0) this.incomplete_.value = true;
  }

  /** Adds the programs of an answer, which may be older than a push: ended programs stay ended. */
  add(programs: readonly ProgramInfo[]): void {
    this.put_([...this.known_.peek().values()], programs);
  }

  get(id: number): ProgramInfo | undefined {
    return this.known_.value.get(id);
  }

  /** Returns the programs that have not ended in their order, then the others, newest first. */
  all(): ProgramInfo[] {
    const programs = [...this.known_.value.values()].sort((a, b) => a.id - b.id);
    return [
      ...programs.filter(isOpen),
      ...programs.filter((program) => !isOpen(program)).reverse(),
    ];
  }

  private put_(kept: readonly ProgramInfo[], newer: readonly ProgramInfo[]): void {
    const known = new Map(kept.map((program) => [program.id, program]));
    for (const program of newer) {
      const before = known.get(program.id);
      if (before && !isOpen(before) && isOpen(program)) continue; // an answer that came late
      known.set(program.id, program);
    }
    this.known_.value = known;
  }
}
