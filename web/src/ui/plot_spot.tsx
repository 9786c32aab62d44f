// SPDX-License-Identifier: Apache-2.0
// The place of the live plots, a chunk that is loaded when there is something to plot.

import { useSignal } from '@preact/signals';
import { useLayoutEffect, useRef } from 'preact/hooks';
import { t } from '../strings';
import type { Plots, PlotsProps } from './plots';

const RETRY_S = 5;

interface PlotSpotProps {
  /** What is plotted; null: nothing yet. */
  plotted: PlotsProps | null;
  /** Loads the code that plots. */
  load?: () => Promise<{ Plots: typeof Plots }>;
}

/** Loads the plots once there is something to plot, and again after a while if they do not load. */
export function PlotSpot({ plotted, load = () => import('./plots') }: PlotSpotProps) {
  const view = useSignal<typeof Plots | null>(null);
  const triedS = useRef(-Infinity);
  const nowS = plotted?.nowS;
  useLayoutEffect(() => {
    if (nowS === undefined || view.peek() || nowS - triedS.current < RETRY_S) return;
    triedS.current = nowS;
    load().then(
      ({ Plots }) => (view.value = Plots),
      (problem: unknown) => console.warn('The plots did not load:', problem),
    );
  }, [nowS]);
  const { value: View } = view;
  return (
    <div class="plot-spot">
      {plotted && View ? <View {...plotted} /> : <p class="quiet">{t('No forces yet.')}</p>}
    </div>
  );
}
