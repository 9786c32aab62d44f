// SPDX-License-Identifier: Apache-2.0
// Three plots over a program's time: force, rate of removal and feed. A slider over all is where the user
// looks, and a line where the program is.

import { t } from '../../strings';
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { spanAt } from '../../model/cut_curve';
import type { CutCurve } from '../../model/cut_curve';
import { cornersOf, feedAt } from '../../model/program_path';
import type { FeedCurve } from '../../model/program_path';
import { h, setText } from '../dom';
import { figure } from '../format';
import { duration } from './texts';

const HEIGHT = 58;
const TIMES_HEIGHT = 20; // of the axis below the lower plot
const LEFT = 44; // of the plotted part, CSS pixels
const RIGHT = 12;
const STEP = 0.01; // of the time, by a key
const PAGE = 0.1;
const STEPPED = uPlot.paths.stepped!({ align: -1 }); // a value is that of the span before

export class CutPlot {
  private readonly now_ = h('div', { class: 'cut-now', hidden: '' });
  private readonly at_ = h('div', { class: 'cut-at', hidden: '' });
  private readonly text_ = h('p', { class: 'quiet cut-text' });
  private readonly frames_ = h('div', { class: 'cut-frames', 'aria-hidden': 'true' });
  private readonly slider_ = h(
    'div',
    {
      class: 'cut-slider',
      role: 'slider',
      tabindex: '0',
      'aria-label': t('Position in the program'),
      'aria-valuemin': '0',
      'aria-valuenow': '0',
    },
    this.frames_,
    this.now_,
    this.at_,
  );
  readonly element = h('div', { class: 'cut-plot' }, this.slider_, this.text_);
  private readonly plots_: uPlot[];
  private curve_: CutCurve = { timesS: [], forcesN: [], removals: [] };
  private feeds_: FeedCurve = { timesS: [], feeds: [] };
  private totalS_ = 1;
  private atS_: number | null = null;
  private line_: number | null = null;

  /** @param picked a time of the program; returns its line, if it is known */
  constructor(private readonly picked: (timeS: number) => number | null) {
    this.plots_ = [
      this.plot_(t('Force, N'), '--force', false),
      this.plot_(t('Removal rate, cm³/min'), '--removal', false),
      this.plot_(t('Feed, mm/min; gaps are rapids'), '--feed', true),
    ];
    const { slider_: slider } = this;
    slider.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      slider.setPointerCapture(event.pointerId);
      this.pick_(this.timeAt_(event));
    });
    slider.addEventListener('pointermove', (event) => {
      if (slider.hasPointerCapture(event.pointerId)) this.pick_(this.timeAt_(event));
    });
    slider.addEventListener('keydown', (event) => this.key_(event));
    new ResizeObserver(() => this.resize_()).observe(this.frames_);
  }

  /** @param totalS the time of the whole program */
  show(curve: CutCurve, totalS: number): void {
    this.curve_ = curve;
    this.totalS_ = Math.max(totalS, curve.timesS.at(-1) ?? 0, 1e-3);
    this.slider_.setAttribute('aria-valuemax', this.totalS_.toFixed(1));
    const [force, removal] = this.plots_;
    force!.setData([curve.timesS, curve.forcesN]);
    removal!.setData([curve.timesS, curve.removals]);
    this.place_();
  }

  /** The feed along the program; null: it is not known yet. */
  setFeeds(feeds: FeedCurve | null): void {
    if (feeds === null || feeds === this.feeds_) return;
    this.feeds_ = feeds;
    this.plots_[2]!.setData(cornersOf(feeds));
    this.place_();
  }

  /** Where the program is, s; null: it does not move. */
  setNow(timeS: number | null): void {
    this.now_.hidden = timeS === null;
    if (timeS !== null) this.put_(this.now_, timeS);
  }

  private plot_(title: string, color: string, isFeed: boolean): uPlot {
    const stroke = getComputedStyle(document.documentElement).getPropertyValue(color).trim();
    const axis = {
      stroke: '#7a8699',
      font: '11px "Inter Variable", sans-serif',
      grid: { stroke: '#8090a640', width: 1 },
      ticks: { show: false },
    };
    this.frames_.append(
      h('p', { class: 'cut-title' }, h('span', { style: `background:${stroke}` }), title),
    );
    return new uPlot(
      {
        width: 280,
        height: isFeed ? HEIGHT + TIMES_HEIGHT : HEIGHT,
        legend: { show: false },
        cursor: { show: false },
        padding: [6, RIGHT, isFeed ? 0 : 4, 0],
        scales: {
          x: { time: false, range: () => [0, this.totalS_] },
          y: { range: (_plot, _low, high) => [0, high > 0 ? high * 1.1 : 1] },
        },
        axes: [
          {
            ...axis,
            show: isFeed,
            size: TIMES_HEIGHT,
            space: 60,
            values: (_plot, at) => at.map((timeS) => duration(timeS)),
          },
          { ...axis, size: LEFT, space: 22, values: (_plot, at) => at.map((v) => figure(v)) },
        ],
        series: [
          {},
          {
            stroke,
            width: 1.4,
            fill: `${stroke}26`,
            points: { show: false },
            paths: isFeed ? uPlot.paths.linear!() : STEPPED,
          },
        ],
      },
      [[], []],
      this.frames_,
    );
  }

  private resize_(): void {
    const width = this.frames_.clientWidth;
    if (width <= 0) return;
    this.plots_.forEach((plot) => {
      if (plot.width !== width) plot.setSize({ width, height: plot.height });
    });
    this.place_();
  }

  private put_(mark: HTMLElement, timeS: number): void {
    const share = Math.min(1, Math.max(0, timeS / this.totalS_));
    mark.style.left = `calc(${LEFT}px + ${share.toFixed(4)} * (100% - ${LEFT + RIGHT}px))`;
  }

  private timeAt_({ clientX }: PointerEvent): number {
    const { left, width } = this.slider_.getBoundingClientRect();
    const share = (clientX - left - LEFT) / Math.max(1, width - LEFT - RIGHT);
    return this.totalS_ * Math.min(1, Math.max(0, share));
  }

  private key_(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const atS = this.atS_ ?? 0;
    const places: Partial<Record<string, number>> = {
      ArrowLeft: atS - STEP * this.totalS_,
      ArrowDown: atS - STEP * this.totalS_,
      ArrowRight: atS + STEP * this.totalS_,
      ArrowUp: atS + STEP * this.totalS_,
      PageDown: atS - PAGE * this.totalS_,
      PageUp: atS + PAGE * this.totalS_,
      Home: 0,
      End: this.totalS_,
    };
    const timeS = places[event.key];
    if (timeS === undefined) return;
    event.preventDefault();
    event.stopPropagation(); // the same keys turn the block
    this.pick_(Math.min(this.totalS_, Math.max(0, timeS)));
  }

  private pick_(timeS: number): void {
    this.atS_ = timeS;
    this.line_ = this.picked(timeS);
    this.place_();
  }

  /** Shows the values at the time that the user inspects. */
  private place_(): void {
    const { atS_: atS, line_: line } = this;
    this.at_.hidden = atS === null;
    if (atS === null) {
      setText(this.text_, t('Click the plot to see the line and the position.'));
      return;
    }
    this.put_(this.at_, atS);
    const n = spanAt(this.curve_, atS);
    const cut =
      n < 0
        ? t('not carved yet')
        : `${figure(this.curve_.forcesN[n]!)} N, ${figure(this.curve_.removals[n]!)} cm³/min`;
    const place = line === null ? duration(atS) : t('{0}, line {1}', duration(atS), line);
    const feed = feedAt(this.feeds_, atS);
    const text = `${place}: ${cut}${feed === null ? '' : `, ${figure(feed)} mm/min`}`;
    setText(this.text_, text);
    this.slider_.setAttribute('aria-valuenow', atS.toFixed(1));
    this.slider_.setAttribute('aria-valuetext', text);
  }
}
