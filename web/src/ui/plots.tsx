// SPDX-License-Identifier: Apache-2.0
// Live plots of force and torque magnitude over the last seconds.

import { useLayoutEffect, useRef } from 'preact/hooks';
import { t } from '../strings';
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { FORCE_WINDOW_S } from '../model/participants';
import type { ForceHistory } from '../model/forces';
import { feltBeside, figure } from './format';

const HEIGHT = 104;

/** Share of the newest wrench that the participant feels; null: not stated; gone: there is none. */
export type Felt = number | null | 'gone';

/** @param nowS returns the right edge */
function optionsOf(color: string, nowS: () => number): uPlot.Options {
  const axis = {
    stroke: '#7a8699',
    font: '11px "Inter Variable", sans-serif',
    grid: { stroke: '#8090a640', width: 1 },
    ticks: { show: false },
  };
  return {
    width: 280,
    height: HEIGHT,
    legend: { show: false },
    cursor: { show: false },
    padding: [8, 12, 0, 0],
    scales: {
      x: { time: false, range: () => [nowS() - FORCE_WINDOW_S, nowS()] },
      y: { range: (_plot, _low, high) => [0, high > 0 ? high * 1.15 : 1] },
    },
    axes: [
      {
        ...axis,
        size: 22,
        space: 48,
        values: (_plot, at) => at.map((t) => `${Math.round(t - nowS()) || 0} s`),
        splits: () => [-10, -5, 0].map((t) => nowS() + t),
      },
      { ...axis, size: 48, space: 26, values: (_plot, at) => at.map((v) => figure(v)) },
    ],
    series: [{}, { stroke: color, width: 1.6, fill: `${color}1f`, points: { show: false } }],
  };
}

interface PlotProps {
  title: string;
  unit: string;
  color: string;
  times: Float64Array;
  values: Float64Array;
  peak: number;
  nowS: number;
  felt: Felt;
}

function Plot({ title, unit, color, times, values, peak, nowS, felt }: PlotProps) {
  const frame = useRef<HTMLDivElement>(null);
  const plot = useRef<uPlot | null>(null);
  const now = useRef(nowS);
  useLayoutEffect(() => {
    const { current } = frame;
    if (!current) return;
    const made = new uPlot(
      optionsOf(color, () => now.current),
      [[], []],
      current,
    );
    plot.current = made;
    const observer = new ResizeObserver(() => {
      const width = current.clientWidth;
      if (width > 0 && width !== made.width) made.setSize({ width, height: HEIGHT });
    });
    observer.observe(current);
    return () => {
      observer.disconnect();
      made.destroy();
    };
  }, [color]);
  useLayoutEffect(() => {
    now.current = nowS;
    plot.current?.setData([times, values]);
  });
  const latest = felt === 'gone' ? undefined : values[values.length - 1];
  const share = felt === 'gone' ? null : felt;
  return (
    <figure
      class="plot"
      aria-live="off"
      aria-label={t('{0}, last {1} seconds', title, FORCE_WINDOW_S)}
    >
      <figcaption>
        <span class="plot-swatch" style={`background:${color}`} />
        {title}
        <span class="plot-value">
          {latest === undefined ? '' : feltBeside(latest, share, unit)}
        </span>
        <span class="plot-peak">{peak > 0 ? t('peak {0}', figure(peak)) : ''}</span>
      </figcaption>
      <div class="plot-frame" ref={frame} />
    </figure>
  );
}

export interface PlotsProps {
  colors: { force: string; torque: string };
  history: ForceHistory;
  /** The right edge, on the clock of the history's samples. */
  nowS: number;
  felt: Felt;
}

/**
 * Samples that are older than the plot are not shown, so a plot of a participant who is gone becomes
 * empty.
 */
export function Plots({ colors, history, nowS, felt }: PlotsProps) {
  history.forget(nowS);
  const [times, forces, torques] = history.series();
  const { forceN, torqueNmm } = history.peak;
  const shared = { times, nowS, felt };
  return (
    <div class="plots">
      <Plot
        {...shared}
        {...{ title: t('Force'), unit: 'N', color: colors.force, values: forces, peak: forceN }}
      />
      <Plot
        {...shared}
        {...{ title: t('Torque'), unit: 'N·mm', color: colors.torque }}
        {...{ values: torques, peak: torqueNmm }}
      />
    </div>
  );
}
