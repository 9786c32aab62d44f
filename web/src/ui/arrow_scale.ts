// SPDX-License-Identifier: Apache-2.0
// The force and the torque of the longest arrows.

import { h, setText } from './dom';
import { figure } from './format';
import type { Picture } from './picture';

export class ArrowScale {
  private readonly force_: HTMLElement;
  private readonly torque_: HTMLElement;
  readonly element: HTMLElement;

  constructor(colors: { force: string; torque: string }) {
    this.force_ = h('span', { style: `--line:${colors.force}` });
    this.torque_ = h('span', { style: `--line:${colors.torque}` });
    const attributes = { class: 'arrow-scale', 'aria-hidden': 'true' };
    this.element = h('div', attributes, this.force_, this.torque_);
  }

  update({ viewer, arrowsVisible }: Picture, hasCarvers: boolean): void {
    this.element.hidden = !viewer || !arrowsVisible || !hasCarvers;
    if (!viewer || this.element.hidden) return;
    const { forceFullN, torqueFullNmm } = viewer.arrowScale;
    setText(this.force_, `${figure(forceFullN)} N`);
    setText(this.torque_, `${figure(torqueFullNmm)} N·mm`);
  }
}
