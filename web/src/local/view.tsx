// SPDX-License-Identifier: Apache-2.0

import type { ComponentChildren } from 'preact';
import { t } from '../strings';
import type { ButtonAction } from '../ui/actions';
import { MainActions } from '../ui/main_actions';
import type { Shell } from '../ui/shell';
import { Bar } from '../ui/title_bar';
import { Toolbar } from '../ui/toolbar';
import { SidePanel } from './side_panel';
import type { SidePanelProps } from './side_panel';
import type { LocalState } from './state';

/** The name of the block, or of the first file. */
function Title({ state }: { state: LocalState }) {
  const { program, scene, stock, journal } = state.files.value;
  const file = (journal ?? program ?? scene ?? stock)?.name;
  const name = state.about.value?.name ?? file ?? t('Without a server');
  return (
    <div class="titles">
      <h1 class="session-name">{name}</h1>
    </div>
  );
}

interface LocalViewProps {
  shell: Shell;
  state: LocalState;
  /** With words. */
  main: readonly ButtonAction[];
  buttons: readonly ButtonAction[];
  panel: SidePanelProps;
  children: ComponentChildren;
}

/** The parts around the picture of the page without a server. */
export function LocalView({ shell, state, main, buttons, panel, children }: LocalViewProps) {
  return (
    <>
      <Bar home={false}>
        <Title state={state} />
      </Bar>
      <MainActions shell={shell} actions={main} />
      <Toolbar shell={shell} actions={buttons} />
      <SidePanel {...panel} />
      {children}
    </>
  );
}
