// SPDX-License-Identifier: Apache-2.0
// The outline of a tool, large, with a handle at each point. The number fields next to it state the
// same for users who do not drag.

import { snapped } from '../../model/profile_draft';
import type { ProfilePoint } from '../../model/profile_draft';
import { toolProfile } from '../../model/tool_profile';
import type { OutlinePoint } from '../../model/tool_profile';
import type { ToolInfo } from '../../wire/types';
import { h } from '../dom';

const WIDTH = 220;
const HEIGHT = 280;
const MARGIN = 16;
const HANDLE = 6;
const TARGET = 12; // where a handle is caught

type Mark = 'path' | 'circle' | 'line';

function svg(name: Mark | 'svg', attributes: Record<string, string>): SVGElement {
  const element = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return element;
}

export class ProfileDrawing {
  private readonly drawing_ = svg('svg', {
    viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
    width: String(WIDTH),
    height: String(HEIGHT),
  });
  readonly element = h('div', { class: 'profile-drawing', 'aria-hidden': 'true' });
  private scale_ = 1; // units of the drawing per mm
  private points_: readonly ProfilePoint[] = [];
  private dragged_: number | null = null;

  /** @param moved a point was dragged to (r, z), mm */
  constructor(private readonly moved: (n: number, r: number, z: number) => void) {
    this.element.append(this.drawing_);
    this.drawing_.addEventListener('pointerdown', (event) => this.down_(event));
    this.drawing_.addEventListener('pointermove', (event) => this.move_(event));
    for (const end of ['pointerup', 'pointercancel'] as const)
      this.drawing_.addEventListener(end, () => (this.dragged_ = null));
  }

  show(tool: ToolInfo, points: readonly ProfilePoint[]): void {
    this.points_ = points;
    const profile = toolProfile(tool);
    if (this.dragged_ === null) {
      const high = Math.max(1, ...points.map(({ z }) => z));
      const wide = Math.max(1, profile.radiusMm, ...points.map(({ r }) => r));
      this.scale_ = Math.min((HEIGHT - 2 * MARGIN) / high, (WIDTH / 2 - MARGIN) / wide);
    }
    const outline = svg('path', { class: 'cutter', d: this.pathOf_(profile.pieces.flat()) });
    const axis = svg('line', {
      class: 'axis',
      x1: String(WIDTH / 2),
      x2: String(WIDTH / 2),
      y1: '0',
      y2: String(HEIGHT),
    });
    this.drawing_.replaceChildren(
      outline,
      axis,
      ...points.map((point, n) => this.handle_(point, n)),
    );
  }

  private at_(r: number, z: number): [x: number, y: number] {
    return [WIDTH / 2 + r * this.scale_, HEIGHT - MARGIN - z * this.scale_];
  }

  private pathOf_(right: readonly OutlinePoint[]): string {
    const left = right.map(([r, z]): OutlinePoint => [-r, z]).reverse();
    const words = [...right, ...left].map(([r, z]) =>
      this.at_(r, z)
        .map((value) => value.toFixed(1))
        .join(),
    );
    return `M${words.join('L')}Z`;
  }

  private handle_({ r, z }: ProfilePoint, n: number): SVGElement {
    const [cx, cy] = this.at_(r, z).map((value) => value.toFixed(1));
    return svg('circle', {
      class: 'handle',
      'data-n': String(n),
      r: String(HANDLE),
      cx: cx!,
      cy: cy!,
    });
  }

  /** Where a pointer is, units of the drawing. */
  private place_({ clientX, clientY }: PointerEvent): [x: number, y: number] {
    const { left, top, width, height } = this.drawing_.getBoundingClientRect();
    return [((clientX - left) / width) * WIDTH, ((clientY - top) / height) * HEIGHT];
  }

  private down_(event: PointerEvent): void {
    const [x, y] = this.place_(event);
    const far = this.points_.map(({ r, z }) => {
      const [px, py] = this.at_(r, z);
      return Math.hypot(px - x, py - y);
    });
    const nearest = far.indexOf(Math.min(...far));
    if (!(far[nearest]! <= TARGET)) return;
    this.dragged_ = nearest;
    this.drawing_.setPointerCapture(event.pointerId);
    event.preventDefault();
  }

  private move_(event: PointerEvent): void {
    if (this.dragged_ === null) return;
    const [x, y] = this.place_(event);
    const r = (x - WIDTH / 2) / this.scale_;
    const z = (HEIGHT - MARGIN - y) / this.scale_;
    this.moved(this.dragged_, Math.max(0, snapped(r)), Math.max(0, snapped(z)));
  }
}
