// SPDX-License-Identifier: Apache-2.0
// Live plots of force and torque magnitude over the last seconds.

import { t } from '../strings';
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { FORCE_WINDOW_S } from '../model/participants';
import type { ForceHistory } from '../model/forces';
import { h, setText } from './dom';
import { feltBeside, figure } from './format';

const HEIGHT = 104;

/** Share of the newest wrench that the participant feels; null: not stated; gone: there is none. */
export type Felt = number | null | 'gone';

class Plot {
  readonly element: HTMLElement;
  private readonly value_ = h('span', { class: 'plot-value' });
  private readonly peak_ = h('span', { class: 'plot-peak' });
  private readonly frame_ = h('div', { class: 'plot-frame' });
  private readonly plot_: uPlot;
  private nowS_ = 0;

  constructor(
    title: string,
    private readonly unit: string,
    color: string,
  ) {
    const swatch = h('span', { class: 'plot-swatch', style: `background:${color}` });
    this.element = h(
      'figure',
      {
        class: 'plot',
        'aria-live': 'off',
        'aria-label': t('{0}, last {1} seconds', title, FORCE_WINDOW_S),
      },
      h('figcaption', {}, swatch, title, this.value_, this.peak_),
      this.frame_,
    );
    const axis = {
      stroke: '#7a8699',
      font: '11px "Inter Variable", sans-serif',
      grid: { stroke: '#8090a640', width: 1 },
      ticks: { show: false },
    };
    this.plot_ = new uPlot(
      {
        width: 280,
        height: HEIGHT,
        legend: { show: false },
        cursor: { show: false },
        padding: [8, 12, 0, 0],
        scales: {
          x: { time: false, range: () => [this.nowS_ - FORCE_WINDOW_S, this.nowS_] },
          y: { range: (_plot, _low, high) => [0, high > 0 ? high * 1.15 : 1] },
        },
        axes: [
          {
            ...axis,
            size: 22,
            space: 48,
            values: (_plot, at) => at.map((t) => `${Math.round(t - this.nowS_) || 0} s`),
            splits: () => [-10, -5, 0].map((t) => this.nowS_ + t),
          },
          { ...axis, size: 48, space: 26, values: (_plot, at) => at.map((v) => figure(v)) },
        ],
        series: [{}, { stroke: color, width: 1.6, fill: `${color}1f`, points: { show: false } }],
      },
      [[], []],
      this.frame_,
    );
  }

  show(times: Float64Array, values: Float64Array, nowS: number, peak: number, felt: Felt): void {
    this.nowS_ = nowS;
    this.plot_.setData([times, values]);
    const latest = felt === 'gone' ? undefined : values[values.length - 1];
    const share = felt === 'gone' ? null : felt;
    setText(this.value_, latest === undefined ? '' : feltBeside(latest, share, this.unit));
    setText(this.peak_, peak > 0 ? t('peak {0}', figure(peak)) : '');
  }

  resize(): void {
    const width = this.frame_.clientWidth;
    if (width > 0 && width !== this.plot_.width) this.plot_.setSize({ width, height: HEIGHT });
  }
}

export class Plots {
  readonly element: HTMLElement;
  private readonly force_: Plot;
  private readonly torque_: Plot;

  constructor(forceColor: string, torqueColor: string) {
    this.force_ = new Plot(t('Force'), 'N', forceColor);
    this.torque_ = new Plot(t('Torque'), 'N·mm', torqueColor);
    this.element = h('div', { class: 'plots' }, this.force_.element, this.torque_.element);
    new ResizeObserver(() => {
      this.force_.resize();
      this.torque_.resize();
    }).observe(this.element);
  }

  /**
   * @param nowS the right edge, on the clock of the history's samples
   * Samples that are older than the plot are not shown, so a plot of a participant who is gone
   * becomes empty.
   */
  show(history: ForceHistory, nowS: number, felt: Felt): void {
    history.forget(nowS);
    const [times, forces, torques] = history.series();
    const { forceN, torqueNmm } = history.peak;
    this.force_.show(times, forces, nowS, forceN, felt);
    this.torque_.show(times, torques, nowS, torqueNmm, felt);
  }
}
