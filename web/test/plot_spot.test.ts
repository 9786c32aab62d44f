// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { ForceHistory } from '../src/model/forces';
import { PlotSpot } from '../src/ui/plot_spot';
import type { Plots } from '../src/ui/plots';
import { stubPage } from './support/fake_dom';
import { turn } from './support/turn';

const COLORS = { force: '#00f', torque: '#f00' };

describe('the place of the plots', () => {
  beforeEach(() => {
    stubPage();
    vi.spyOn(console, 'warn').mockReturnValue(undefined);
  });
  afterEach(() => {
    vi.unstubAllGlobals();
    vi.restoreAllMocks();
  });

  it('loads the plots once there is something to plot, and shows all that follows', async () => {
    const shown: number[] = [];
    class FakePlots {
      readonly element = document.createElement('div');
      show(_history: ForceHistory, nowS: number): void {
        shown.push(nowS);
      }
    }
    const load = vi.fn(() => Promise.resolve({ Plots: FakePlots as unknown as typeof Plots }));
    const spot = new PlotSpot(COLORS, load);
    expect(load).not.toHaveBeenCalled();
    spot.show(new ForceHistory(1), 10, 1);
    spot.show(new ForceHistory(1), 10.1, 1);
    await turn();
    spot.show(new ForceHistory(1), 10.2, 1);
    expect(load).toHaveBeenCalledTimes(1);
    expect(shown).toEqual([10.2]);
    expect(spot.element.textContent).toBe('');
  });

  it('tries again after 5 s where they did not load', async () => {
    const load = vi.fn(() => Promise.reject(new Error('offline')));
    const spot = new PlotSpot(COLORS, load);
    for (const nowS of [0, 1, 4.9, 5.1, 6]) {
      spot.show(new ForceHistory(1), nowS, 1);
      await turn();
    }
    expect(load).toHaveBeenCalledTimes(2);
  });
});
