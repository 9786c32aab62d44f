// SPDX-License-Identifier: Apache-2.0
// Undo and redo of several strokes, one after the other: all of them, or none.

interface Group {
  undone: boolean;
  strokes: number;
  done: number;
  /** Going back after a failure. */
  fails: boolean;
  ended: (changed: boolean) => void;
}

export class Changes {
  private groups_: Group[] = [];
  private isAsking_ = false;

  /** `ask`: undoes the newest stroke, or redoes the one that was undone last; answered() follows. */
  constructor(private readonly ask: (undone: boolean) => void) {}

  get isBusy(): boolean {
    return this.groups_.length > 0;
  }

  /** Strokes that are still to be asked for. */
  get waiting(): number {
    const all = this.groups_.reduce((sum, { strokes, done }) => sum + strokes - done, 0);
    return all - Number(this.isAsking_);
  }

  /** `ended`: with false nothing has changed. */
  add(undone: boolean, strokes: number, ended: (changed: boolean) => void): void {
    this.groups_.push({ undone, strokes, done: 0, fails: false, ended });
    this.next_();
  }

  /** Returns true if this was the first failure, which the user is told. */
  answered(ok: boolean): boolean {
    const [group] = this.groups_;
    this.isAsking_ = false;
    if (!group) return false;
    const isFirst = !ok && !group.fails;
    group.fails ||= !ok;
    // A stroke that cannot be put back is left: trying again would lead no further.
    group.done = ok ? group.done + (group.fails ? -1 : 1) : isFirst ? group.done : 0;
    this.next_();
    return isFirst;
  }

  drop(): void {
    this.groups_ = [];
    this.isAsking_ = false;
  }

  private next_(): void {
    const [group] = this.groups_;
    if (!group || this.isAsking_) return;
    const { undone, strokes, done, fails, ended } = group;
    if (done === (fails ? 0 : strokes)) {
      this.groups_.shift();
      ended(!fails);
      this.next_();
      return;
    }
    this.isAsking_ = true;
    this.ask(fails ? !undone : undone);
  }
}
