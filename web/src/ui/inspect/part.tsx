// SPDX-License-Identifier: Apache-2.0
// The action that opens the panel for sections and measures. The panel is a chunk of its own.

import type { VNode } from 'preact';
import { t } from '../../strings';
import type { ButtonAction } from '../actions';
import { ICONS } from '../icons';
import { LazyPanel } from '../lazy_panel';
import { Live } from '../live';
import type { InspectHost } from './host';

interface ViewedPanel {
  toggle: () => void;
  view: () => VNode;
}

export class InspectPart {
  readonly action: ButtonAction;
  private readonly panel_: LazyPanel<ViewedPanel>;

  constructor(host: InspectHost) {
    this.panel_ = new LazyPanel('panel', async () => {
      const [{ InspectPanel }, { InspectView }] = await Promise.all([
        import('./inspect_panel'),
        import('./inspect_view'),
      ]);
      const panel = new InspectPanel(host, host.picture.viewer!);
      return { toggle: () => panel.toggle(), view: () => <InspectView panel={panel} /> };
    });
    const label = t('Sections and measurements');
    this.action = {
      ...{ name: 'inspect', label, key: 'I', icon: ICONS.inspect },
      isExpanded: () => host.shell.isInspectOpen.value,
      perform: () => {
        if (host.picture.viewer) this.panel_.toggle(); // without a picture there is nothing to inspect
      },
    };
  }

  view(): VNode {
    return <Live view={() => this.panel_.loaded?.view()} />;
  }
}
