// SPDX-License-Identifier: Apache-2.0
// The shares of the surface by their deviation, as bars in the colors of the picture.

import { t } from '../../strings';
import { binShares, colorOf } from '../../model/deviation';
import { inUnit } from '../../model/measure';
import type { LengthUnit } from '../../model/measure';
import { h } from '../dom';
import { figure } from '../format';

const BINS = 41;
const WIDTH = 244;
const HEIGHT = 56;
/** Height of the smallest share above 0, relative to the plot, so that outliers are seen. */
const LEAST = 0.04;

function svg(tag: string, attributes: Record<string, string | number>): SVGElement {
  const element = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  return element;
}

/** With a sign, whatever it is. */
export function signed(mm: number, unit: LengthUnit): string {
  const value = inUnit(mm, unit);
  return `${value < 0 ? '−' : '+'}${figure(Math.abs(value))}`;
}

export class DeviationPlot {
  private readonly bars_ = svg('svg', {
    viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
    preserveAspectRatio: 'none',
    class: 'deviation-bars',
    role: 'img',
  });
  private readonly axis_ = h('p', { class: 'deviation-axis quiet' });
  readonly element = h('div', { class: 'deviation-plot' }, this.bars_, this.axis_);

  show(quantiles: readonly number[], tolerance: number, range: number, unit: LengthUnit): void {
    const shares = binShares(quantiles, range, BINS);
    const most = Math.max(...shares, 1e-9);
    const side = WIDTH / BINS;
    const at = (mm: number): number => (WIDTH * (mm + range)) / (2 * range);
    const bars = shares.map((share, n) => {
      // Of a bin that the limit of the tolerance divides, the middle counts.
      const mm = range * ((2 * (n + 0.5)) / BINS - 1);
      const height = share > 0 ? HEIGHT * Math.max(LEAST, Math.sqrt(share / most)) : 0;
      return svg('rect', {
        x: n * side,
        y: HEIGHT - height,
        width: side - 0.6,
        height,
        fill: colorOf(mm, tolerance, range),
      });
    });
    const limits = [-tolerance, tolerance].map((mm) =>
      svg('line', { x1: at(mm), x2: at(mm), y1: 0, y2: HEIGHT, class: 'deviation-limit' }),
    );
    this.bars_.replaceChildren(...bars, ...limits);
    this.bars_.setAttribute(
      'aria-label',
      t(
        'Share of the surface by deviation, {0} to {1} {2}',
        signed(-range, unit),
        signed(range, unit),
        unit,
      ),
    );
    this.axis_.replaceChildren(
      h('span', {}, t('{0} too deep', signed(-range, unit))),
      h('span', {}, '0'),
      h('span', {}, t('left over {0} {1}', signed(range, unit), unit)),
    );
  }
}
