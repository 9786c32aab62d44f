// SPDX-License-Identifier: Apache-2.0
// The path of the program in the picture. Its code needs that of the view, which comes later than the
// panel's.

import { signal } from '@preact/signals';
import { pathOfAnswer } from '../model/program_path';
import type { Picture } from '../ui/picture';
import type { PathControl } from '../ui/programs/path_control';
import type { PathRow } from '../ui/programs/path_row';
import type { Shell } from '../ui/shell';
import type { About, Progress } from './program_block';

export interface ShownPath {
  control: PathControl;
  Row: typeof PathRow;
}

export class LocalPath {
  /** Null until the code is there. */
  readonly shown = signal<ShownPath | null>(null);

  /** @param pressed a line was pressed in the picture */
  constructor(
    private readonly picture: Picture,
    private readonly shell: Shell,
    private readonly pressed: (line: number) => void,
  ) {}

  /**
   * Shows a path.
   * @param isCurrent returns whether the block is still that of the path
   */
  async show(path: unknown, isCurrent: () => boolean): Promise<void> {
    const [{ PathControl }, { PathRow }] = await Promise.all([
      import('../ui/programs/path_control'),
      import('../ui/programs/path_row'),
    ]);
    await this.picture.opened();
    if (!isCurrent()) return;
    const { picture, shell } = this;
    if (!this.shown.peek()) {
      const host = { picture, canvas: shell.canvas, overlay: shell.overlay };
      const control = new PathControl(host, () => Promise.reject(new Error('no path')));
      control.pressed = this.pressed;
      control.setOpen(true);
      this.shown.value = { control, Row: PathRow };
    }
    this.shown.peek()?.control.show(pathOfAnswer(path));
  }

  hide(): void {
    this.shown.peek()?.control.show(null);
  }

  markLine(line: number): void {
    this.shown.peek()?.control.markLine(line);
  }

  /** Shows how much of the path is done. */
  reach({ carved, line }: Progress, { motions }: About): void {
    this.shown.peek()?.control.reach(carved, motions, line);
  }
}
