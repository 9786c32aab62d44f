// SPDX-License-Identifier: Apache-2.0
// Three plots over a program's time: force, rate of removal and feed. One slider over all marks the
// inspected time, and a line the program's.

import { useSignal } from '@preact/signals';
import type { Signal } from '@preact/signals';
import { useLayoutEffect, useMemo, useRef } from 'preact/hooks';
import { t } from '../../strings';
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { spanAt } from '../../model/cut_curve';
import type { CutCurve } from '../../model/cut_curve';
import { cornersOf, feedAt } from '../../model/program_path';
import type { FeedCurve } from '../../model/program_path';
import { figure } from '../format';
import type { CutControl } from './cut_control';
import { duration } from './texts';

const HEIGHT = 58;
const TIMES_HEIGHT = 20; // of the axis below the lower plot
const LEFT = 44; // of the plotted part, CSS pixels
const RIGHT = 12;
const STEP = 0.01; // of the time, by a key
const PAGE = 0.1;
const STEPPED = uPlot.paths.stepped!({ align: -1 }); // a value is that of the span before
const NO_FEEDS: FeedCurve = { timesS: [], feeds: [] };

/** The time that the user inspects, and the line that was carved then, if it is known. */
interface Picked {
  timeS: number;
  line: number | null;
}

function optionsOf(stroke: string, isFeed: boolean, totalS: () => number): uPlot.Options {
  const axis = {
    stroke: '#7a8699',
    font: '11px "Inter Variable", sans-serif',
    grid: { stroke: '#8090a640', width: 1 },
    ticks: { show: false },
  };
  return {
    width: 280,
    height: isFeed ? HEIGHT + TIMES_HEIGHT : HEIGHT,
    legend: { show: false },
    cursor: { show: false },
    padding: [6, RIGHT, isFeed ? 0 : 4, 0],
    scales: {
      x: { time: false, range: () => [0, totalS()] },
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
  };
}

interface PlotProps {
  title: string;
  /** A CSS variable. */
  color: string;
  isFeed?: boolean;
  data: uPlot.AlignedData;
  totalS: number;
}

function Plot({ title, color, isFeed = false, data, totalS }: PlotProps) {
  const frame = useRef<HTMLDivElement>(null);
  const plot = useRef<uPlot | null>(null);
  const total = useRef(totalS);
  const stroke = getComputedStyle(document.documentElement).getPropertyValue(color).trim();
  useLayoutEffect(() => {
    const { current } = frame;
    if (!current) return;
    const made = new uPlot(
      optionsOf(stroke, isFeed, () => total.current),
      data,
      current,
    );
    plot.current = made;
    const observer = new ResizeObserver(() => {
      const width = current.clientWidth;
      if (width > 0 && width !== made.width) made.setSize({ width, height: made.height });
    });
    observer.observe(current);
    return () => {
      observer.disconnect();
      made.destroy();
    };
  }, []);
  useLayoutEffect(() => {
    total.current = totalS;
    plot.current?.setData(data);
  }, [data, totalS]);
  return (
    <>
      <p class="cut-title">
        <span style={`background:${stroke}`} />
        {title}
      </p>
      <div ref={frame} />
    </>
  );
}

/** The style of a vertical line at a time. */
function placeOf(timeS: number | null, totalS: number): string {
  if (timeS === null) return '';
  const share = Math.min(1, Math.max(0, timeS / totalS));
  return `left:calc(${LEFT}px + ${share.toFixed(4)} * (100% - ${LEFT + RIGHT}px))`;
}

/** The time at which a key puts the slider; undefined: the key means nothing. */
function timeOfKey(key: string, atS: number, totalS: number): number | undefined {
  const places: Partial<Record<string, number>> = {
    ArrowLeft: atS - STEP * totalS,
    ArrowDown: atS - STEP * totalS,
    ArrowRight: atS + STEP * totalS,
    ArrowUp: atS + STEP * totalS,
    PageDown: atS - PAGE * totalS,
    PageUp: atS + PAGE * totalS,
    Home: 0,
    End: totalS,
  };
  const timeS = places[key];
  return timeS === undefined ? undefined : Math.min(totalS, Math.max(0, timeS));
}

/** The values at the time that the user inspects. */
function textOf({ timeS, line }: Picked, curve: CutCurve, feeds: FeedCurve): string {
  const n = spanAt(curve, timeS);
  const cut =
    n < 0
      ? t('not carved yet')
      : `${figure(curve.forcesN[n]!)} N, ${figure(curve.removals[n]!)} cm³/min`;
  const place = line === null ? duration(timeS) : t('{0}, line {1}', duration(timeS), line);
  const feed = feedAt(feeds, timeS);
  return `${place}: ${cut}${feed === null ? '' : `, ${figure(feed)} mm/min`}`;
}

/** The handlers of a slider over the plots. */
function sliderOf(control: CutControl, picked: Signal<Picked | null>) {
  const totalS = control.totalS.value;
  const pick = (timeS: number): void => {
    picked.value = { timeS, line: control.picked(timeS) };
  };
  const pickAt = ({ clientX, currentTarget }: PointerEvent & { currentTarget: HTMLElement }) => {
    const { left, width } = currentTarget.getBoundingClientRect();
    const share = (clientX - left - LEFT) / Math.max(1, width - LEFT - RIGHT);
    pick(totalS * Math.min(1, Math.max(0, share)));
  };
  return {
    onPointerDown: (event: PointerEvent & { currentTarget: HTMLElement }) => {
      if (event.button !== 0) return;
      event.currentTarget.setPointerCapture(event.pointerId);
      pickAt(event);
    },
    onPointerMove: (event: PointerEvent & { currentTarget: HTMLElement }) => {
      if (event.currentTarget.hasPointerCapture(event.pointerId)) pickAt(event);
    },
    onKeyDown: (event: KeyboardEvent) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const timeS = timeOfKey(event.key, picked.value?.timeS ?? 0, totalS);
      if (timeS === undefined) return;
      event.preventDefault();
      event.stopPropagation(); // the same keys turn the block
      pick(timeS);
    },
  };
}

export function CutPlot({ control, curve }: { control: CutControl; curve: CutCurve }) {
  const picked = useSignal<Picked | null>(null);
  const feeds = control.feeds() ?? NO_FEEDS;
  const totalS = control.totalS.value;
  const { value: at } = picked;
  const text = at && textOf(at, curve, feeds);
  const { timesS, forcesN, removals } = curve;
  const forces = useMemo((): uPlot.AlignedData => [timesS, forcesN], [curve]);
  const rates = useMemo((): uPlot.AlignedData => [timesS, removals], [curve]);
  const corners = useMemo(() => cornersOf(feeds), [feeds]);
  const nowS = control.nowS.value;
  return (
    <div class="cut-plot">
      <div
        class="cut-slider"
        role="slider"
        tabIndex={0}
        aria-label={t('Position in the program')}
        aria-valuemin={0}
        aria-valuemax={Number(totalS.toFixed(1))}
        aria-valuenow={Number((at?.timeS ?? 0).toFixed(1))}
        aria-valuetext={text ?? undefined}
        {...sliderOf(control, picked)}
      >
        <div class="cut-frames" aria-hidden="true">
          <Plot {...{ title: t('Force, N'), color: '--force', totalS }} data={forces} />
          <Plot
            {...{ title: t('Removal rate, cm³/min'), color: '--removal', totalS }}
            data={rates}
          />
          <Plot
            {...{ title: t('Feed, mm/min; gaps are rapids'), color: '--feed', totalS }}
            isFeed
            data={corners}
          />
        </div>
        <div class="cut-now" hidden={nowS === null} style={placeOf(nowS, totalS)} />
        <div class="cut-at" hidden={at === null} style={placeOf(at?.timeS ?? null, totalS)} />
      </div>
      <p class="quiet cut-text">{text ?? t('Click the plot to see the line and the position.')}</p>
    </div>
  );
}
