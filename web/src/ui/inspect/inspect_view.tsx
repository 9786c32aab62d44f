// SPDX-License-Identifier: Apache-2.0

import { t } from '../../strings';
import { lengthText } from '../../model/measure';
import { useCovering } from '../shell';
import { DeviationControls } from './deviation_controls';
import { HandleView } from './handle';
import type { InspectPanel } from './inspect_panel';
import { MeasureControls } from './measure_controls';
import { OwnerTipView } from './owner_tip';
import { OwningView } from './owning_view';
import { ProbingView } from './probing';
import { SectionControls } from './section_controls';
import { ViewCubeView } from './view_cube';

interface ToggleProps {
  name: string;
  title?: string;
  isPressed: boolean;
  press: () => void;
}

function Toggle({ name, title, isPressed, press }: ToggleProps) {
  return (
    <button
      type="button"
      class="inspect-action"
      title={title}
      aria-pressed={isPressed}
      onClick={press}
    >
      {name}
    </button>
  );
}

/** The cube of views, and what is shown in the picture. */
function Foot({ panel }: { panel: InspectPanel }) {
  const { ghost } = panel;
  const hasCurvature = panel.hasCurvature.value;
  return (
    <div class="inspect-foot">
      <ViewCubeView cube={panel.cube} view={(preset) => panel.show(preset)} />
      <div class="inspect-toggles">
        <Toggle
          name={t('Parallel')}
          isPressed={panel.isParallel.value}
          press={() => panel.toggleParallel()}
        />
        <Toggle
          name={t('Curvature')}
          isPressed={hasCurvature}
          press={() => panel.showCurvature(!hasCurvature)}
        />
        {ghost && (
          <Toggle
            name={t('Stock')}
            title={t('Show the stock before the first cut')}
            isPressed={ghost.isWanted.value}
            press={() => ghost.toggle()}
          />
        )}
        <Toggle
          name={t('Inches')}
          isPressed={panel.units.value === 'in'}
          press={() => panel.toggleUnits()}
        />
      </div>
    </div>
  );
}

function CurvatureLegend({ panel }: { panel: InspectPanel }) {
  if (!panel.hasCurvature.value) return null;
  const radius = lengthText(panel.curvatureMm, panel.units.value);
  return (
    <p class="curvature-legend">
      <span class="hollow">{t('hollow')}</span>
      <span class="raised">{t('raised')}</span>
      {t('full color up to a radius of {0}', radius)}
    </p>
  );
}

function SectionHandle({ panel: { sectioning, units } }: { panel: InspectPanel }) {
  const { plane, shown } = sectioning;
  return (
    <HandleView
      handle={sectioning.handle}
      plane={plane}
      text={lengthText(shown.mm ?? 0, units.value)}
      stepMm={plane ? sectioning.stepMm : 0}
      moved={(offset) => sectioning.moveTo(offset)}
    />
  );
}

/** The panel for sections and measures, and its elements over the picture. */
export function InspectView({ panel }: { panel: InspectPanel }) {
  const { host, sectioning, measuring, probing, owning, comparing, tip } = panel;
  const element = useCovering<HTMLElement>(host.shell, '--inspect');
  const isOpen = host.shell.isInspectOpen.value;
  const units = panel.units.value;
  const label = t('Sections and measurements');
  return (
    <>
      <section ref={element} class="inspect" aria-label={label} hidden={!isOpen}>
        <header>
          <h2>{t('Inspect')}</h2>
          <button type="button" class="inspect-action" onClick={() => panel.toggle()}>
            {t('Close')}
          </button>
        </header>
        <SectionControls shown={sectioning.shown} units={units} actions={sectioning.actions} />
        <MeasureControls measuring={measuring} units={units} />
        {probing && <ProbingView probing={probing} units={units} />}
        {owning && <OwningView owning={owning} />}
        {comparing && <DeviationControls comparing={comparing} units={units} />}
        <Foot panel={panel} />
        <CurvatureLegend panel={panel} />
      </section>
      <SectionHandle panel={panel} />
      {tip && <OwnerTipView tip={tip} />}
    </>
  );
}
