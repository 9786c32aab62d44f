// SPDX-License-Identifier: Apache-2.0
// The card that is shown before there is a block.

import { t } from '../strings';
import { h } from '../ui/dom';
import { ageText } from '../model/new_block';
import { ToolRack } from '../ui/tools/tool_rack';
import type { ToolInfo } from '../wire/types';
import { forgetStrokes, keptStrokes } from './autosave';
import type { KeptStrokes } from './autosave';
import { EXAMPLE_TOOLS } from './example';
import type { GivenFile } from './program_block';

export interface StartActions {
  choose: () => void;
  example: () => void;
  /** Carves a block by hand with these tools. */
  carve: (tools: readonly ToolInfo[]) => void;
  /** Opens the file of strokes that the browser has kept. */
  goOn: (file: GivenFile) => void;
}

function button(text: string, action: () => void): HTMLElement {
  const element = h('button', { type: 'button', class: 'button' }, text);
  element.addEventListener('click', action);
  return element;
}

/** Offers strokes of a page that was closed before they were in a file. */
function offer(place: HTMLElement, kept: KeptStrokes, goOn: StartActions['goOn']): void {
  const done = (act: () => void) => () => {
    place.replaceChildren();
    act();
  };
  place.replaceChildren(
    h('p', {}, t('You have unsaved strokes from {0}.', ageText(kept.atMs, Date.now()))),
    h(
      'div',
      { class: 'page-actions' },
      button(
        t('Restore'),
        done(() => goOn(kept)),
      ),
      button(
        t('Discard'),
        done(() => void forgetStrokes()),
      ),
    ),
  );
}

export function startCard({ choose, example, carve, goOn }: StartActions): HTMLElement {
  const rack = new ToolRack(EXAMPLE_TOOLS, () => undefined);
  const kept = h('div', { class: 'kept-strokes', role: 'status' });
  keptStrokes().then(
    (strokes) => {
      if (strokes) offer(kept, strokes, goOn);
    },
    (problem: unknown) => console.warn(problem), // the browser stores nothing
  );
  return h(
    'section',
    { class: 'start', 'aria-label': t('Without a server') },
    kept,
    h('h2', {}, t('Drop an NC program or a KERF file here')),
    h(
      'p',
      {},
      t(
        'G-code, Klartext or APT. You can add a scene (JSON) or a model as stock (STL, PLY, OBJ). Everything stays in this browser: nothing is uploaded.',
      ),
    ),
    h(
      'div',
      { class: 'page-actions' },
      button(t('Choose files…'), choose),
      button(t('Try an example'), example),
      button(t('Carve a block by hand'), () => carve(rack.tools)),
    ),
    h(
      'details',
      { class: 'start-tools' },
      h('summary', {}, t('Tools for carving by hand')),
      rack.element,
    ),
  );
}
