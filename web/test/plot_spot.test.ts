// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { h, render } from 'preact';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { ForceHistory } from '../src/model/forces';
import { PlotSpot } from '../src/ui/plot_spot';
import type { Plots, PlotsProps } from '../src/ui/plots';
import { turn } from './support/turn';

const COLORS = { force: '#00f', torque: '#f00' };
type Load = () => Promise<{ Plots: typeof Plots }>;

describe('the place of the plots', () => {
  let root: HTMLElement;

  beforeEach(() => {
    root = document.createElement('div');
    vi.spyOn(console, 'warn').mockReturnValue(undefined);
  });
  afterEach(() => vi.restoreAllMocks());

  async function plot(load: Load, nowS: number | null): Promise<void> {
    const history = new ForceHistory(1);
    const plotted = nowS === null ? null : { colors: COLORS, history, nowS, felt: 1 };
    render(h(PlotSpot, { plotted, load }), root);
    await turn();
  }

  it('loads the plots once there is something to plot, and shows all that follows', async () => {
    const shown: number[] = [];
    const Fake = ({ nowS }: PlotsProps) => {
      shown.push(nowS);
      return h('b', {}, 'plots');
    };
    const load = vi.fn(() => Promise.resolve({ Plots: Fake }));
    await plot(load, null);
    expect(load).not.toHaveBeenCalled();
    expect(root.textContent).toBe('No forces yet.');
    for (const nowS of [10, 10.1, 10.2]) await plot(load, nowS);
    expect(load).toHaveBeenCalledTimes(1);
    expect(shown.at(-1)).toBe(10.2);
    expect(root.textContent).toBe('plots');
  });

  it('tries again after 5 s where they did not load', async () => {
    const load = vi.fn(() => Promise.reject(new Error('offline')));
    for (const nowS of [0, 1, 4.9, 5.1, 6]) await plot(load, nowS);
    expect(load).toHaveBeenCalledTimes(2);
  });
});
