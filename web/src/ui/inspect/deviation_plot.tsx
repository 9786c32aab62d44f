// SPDX-License-Identifier: Apache-2.0
// The shares of the surface by their deviation, as bars in the colors of the picture.

import { t } from '../../strings';
import { binShares, colorOf } from '../../model/deviation';
import { inUnit } from '../../model/measure';
import type { LengthUnit } from '../../model/measure';
import { figure } from '../format';

const BINS = 41;
const WIDTH = 244;
const HEIGHT = 56;
/** Height of the smallest share above 0, relative to the plot, so that outliers are seen. */
const LEAST = 0.04;

/** With a sign, whatever it is. */
export function signed(mm: number, unit: LengthUnit): string {
  const value = inUnit(mm, unit);
  return `${value < 0 ? '−' : '+'}${figure(Math.abs(value))}`;
}

interface DeviationPlotProps {
  quantiles: readonly number[];
  /** mm, as the range of the plot on both sides of 0. */
  tolerance: number;
  range: number;
  unit: LengthUnit;
}

export function DeviationPlot({ quantiles, tolerance, range, unit }: DeviationPlotProps) {
  const shares = binShares(quantiles, range, BINS);
  const most = Math.max(...shares, 1e-9);
  const side = WIDTH / BINS;
  const at = (mm: number): number => (WIDTH * (mm + range)) / (2 * range);
  const [least, greatest] = [signed(-range, unit), signed(range, unit)];
  const label = t('Share of the surface by deviation, {0} to {1} {2}', least, greatest, unit);
  return (
    <div class="deviation-plot">
      <svg
        viewBox={`0 0 ${WIDTH} ${HEIGHT}`}
        preserveAspectRatio="none"
        class="deviation-bars"
        role="img"
        aria-label={label}
      >
        {shares.map((share, n) => {
          // Of a bin that the limit of the tolerance divides, the middle counts.
          const mm = range * ((2 * (n + 0.5)) / BINS - 1);
          const height = share > 0 ? HEIGHT * Math.max(LEAST, Math.sqrt(share / most)) : 0;
          return (
            <rect
              key={n}
              x={n * side}
              y={HEIGHT - height}
              width={side - 0.6}
              height={height}
              fill={colorOf(mm, tolerance, range)}
            />
          );
        })}
        {[-tolerance, tolerance].map((mm) => (
          <line key={mm} x1={at(mm)} x2={at(mm)} y1={0} y2={HEIGHT} class="deviation-limit" />
        ))}
      </svg>
      <p class="deviation-axis quiet">
        <span>{t('{0} too deep', least)}</span>
        <span>0</span>
        <span>{t('left over {0} {1}', greatest, unit)}</span>
      </p>
    </div>
  );
}
