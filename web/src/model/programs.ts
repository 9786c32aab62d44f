// SPDX-License-Identifier: Apache-2.0
// The NC programs of the session: what the server pushes, and what it answers over HTTP.

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

export class Programs {
  private readonly known_ = new Map<number, ProgramInfo>();
  /** Grows with each change. */
  changes = 0;
  /** A program has ended and was not among those that were pushed: ask for the list. */
  incomplete = false;

  clear(): void {
    this.known_.clear();
    this.changes += 1;
    this.incomplete = false;
  }

  /** A message of the server: all programs that have not ended, and some that have. */
  apply(pushed: readonly ProgramInfo[]): void {
    const listed = new Set(pushed.map((program) => program.id));
    for (const program of this.known_.values()) {
      if (!isOpen(program) || listed.has(program.id)) continue;
      this.known_.delete(program.id);
      this.incomplete = true;
    }
    this.add(pushed);
  }

  /** What a request was answered with; what is known of a program that has ended stays. */
  add(programs: readonly ProgramInfo[]): void {
    for (const program of programs) {
      const known = this.known_.get(program.id);
      if (known && !isOpen(known) && isOpen(program)) continue; // an answer that came late
      this.known_.set(program.id, program);
    }
    this.changes += 1;
  }

  get(id: number): ProgramInfo | undefined {
    return this.known_.get(id);
  }

  /** Those that have not ended in their order, then the others, newest first. */
  all(): ProgramInfo[] {
    const programs = [...this.known_.values()].sort((a, b) => a.id - b.id);
    return [
      ...programs.filter(isOpen),
      ...programs.filter((program) => !isOpen(program)).reverse(),
    ];
  }
}
