// SPDX-License-Identifier: Apache-2.0
// The button that opens the panel for sections and measures. The panel is a chunk of its own.

import { t } from '../../strings';
import type { SessionModel } from '../../model/session';
import type { Vec3 } from '../../wire/types';
import { iconButton } from '../dom';
import { ICONS } from '../icons';
import { lazyPanel } from '../lazy_panel';
import type { OneOpen } from '../one_open';
import type { Picture } from '../picture';

/** A line of a program, and a place that it cut. */
export interface ProgramPlace {
  program: number;
  line: number;
  place: Vec3;
}

/** What the panel needs of the page. */
export interface InspectHost {
  model: SessionModel;
  /** Null: without a server. */
  session: string | null;
  picture: Picture;
  canvas: HTMLCanvasElement;
  /** Over the picture, for what follows the block. */
  overlay: HTMLElement;
  toolbar: HTMLElement;
  oneOpen: OneOpen;
  /** It was opened or closed, and covers another part of the picture. */
  layoutChanged: () => void;
  /** Shows a line in the panel of programs; undefined: there is none. */
  showLine?: (place: ProgramPlace) => void;
}

/** Adds the button to the toolbar; returns what it does. */
export function mountInspect(host: InspectHost): () => void {
  const open = lazyPanel('panel', async () => {
    const { InspectPanel } = await import('./inspect_panel');
    return new InspectPanel(host, host.picture.viewer!, button);
  });
  const toggle = (): void => {
    if (host.picture.viewer) open(); // without a picture there is nothing to inspect
  };
  const button = iconButton(ICONS.inspect, t('Sections and measurements'), 'I', toggle);
  button.setAttribute('aria-expanded', 'false');
  host.toolbar.firstElementChild?.after(button);
  return toggle;
}
