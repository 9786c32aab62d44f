// SPDX-License-Identifier: Apache-2.0
// The bar below the picture while one carves: the rack of tools, how the tool follows, its depth,
// undo, and messages.

import { t } from '../strings';
import './carve.css';
import { toolName, toolProfile } from '../model/tool_profile';
import { h, setText } from '../ui/dom';
import { figure } from '../ui/format';
import type { ToolInfo } from '../wire/types';
import type { AimMode } from './aim';
import type { DragStrength } from './drag';
import { commonScale, silhouette } from '../ui/silhouette';

export interface BarActions {
  chooseTool: (id: number) => void;
  chooseMode: (mode: AimMode) => void;
  toggleLean: () => void;
  nextDrag: () => void;
  setDepth: (mm: number) => void;
  undo: () => void;
  redo: () => void;
  /** Lets the user choose a 3D mouse; null: the browser can have none. */
  spaceMouse: (() => void) | null;
  done: () => void;
}

const MODES: readonly [AimMode, string, string][] = [
  ['surface', t('Surface'), t('The tip follows the surface as it was before this stroke (P)')],
  ['plane', t('Plane'), t('The tip stays on the plane where the stroke began (P)')],
];
const DRAGS: Record<DragStrength, string> = {
  off: t('Resistance: off'),
  light: t('Resistance: light'),
  strong: t('Resistance: strong'),
};
const SLIDER_STEPS = 1000;

function button(label: string, title: string, action: () => void): HTMLButtonElement {
  const element = h('button', { type: 'button', title }, label);
  element.addEventListener('click', action);
  return element;
}

function press(element: HTMLElement, is: boolean): void {
  element.setAttribute('aria-pressed', String(is));
}

export function isTouched(): boolean {
  return matchMedia('(pointer: coarse)').matches;
}

/** How to carve with the user's pointing device. */
export function helpText(): string {
  return isTouched()
    ? t(
        'One finger carves, two rotate and zoom, three pan. Hold for a flat plane. Tap with two to undo.',
      )
    : t(
        'Drag on the block to carve. Shift: straight line. Alt: flat plane. Right-drag rotates, the wheel zooms, Esc exits.',
      );
}

export class CarveBar {
  readonly element: HTMLElement;
  private readonly rack_ = h('div', {
    class: 'carve-rack',
    role: 'group',
    'aria-label': t('Tool'),
  });
  private readonly tools_ = new Map<number, HTMLElement>();
  private readonly modes_ = new Map<AimMode, HTMLElement>();
  private readonly lean_: HTMLElement;
  private readonly drag_: HTMLElement;
  private readonly spaceMouse_: HTMLElement;
  private readonly slider_ = h('input', {
    type: 'range',
    min: '0',
    max: String(SLIDER_STEPS),
    'aria-label': t('Depth'),
    title: t('Depth below the surface (Ctrl + wheel, or pen pressure)'),
  });
  private readonly depth_ = h('output', { class: 'carve-depth-value' });
  private readonly note_ = h('p', { class: 'carve-note', role: 'status' });
  private depthRange_: [least: number, most: number] = [0.1, 10];

  constructor(private readonly actions: BarActions) {
    const modes = MODES.map(([mode, label, title]) => {
      const element = button(label, title, () => actions.chooseMode(mode));
      this.modes_.set(mode, element);
      return element;
    });
    this.lean_ = button(
      t('Lean'),
      t('Leans the tool with the surface or the pen, up to 45° (L)'),
      actions.toggleLean,
    );
    this.drag_ = button(
      DRAGS.off,
      t('Holds the tool back in heavy cuts: off, light or strong (D)'),
      actions.nextDrag,
    );
    this.slider_.addEventListener('input', () => actions.setDepth(this.sliderMm_()));
    this.spaceMouse_ = button(
      t('3D mouse'),
      t('Connect a 3D mouse: the cap moves and leans the tool, the left button cuts'),
      () => actions.spaceMouse?.(),
    );
    this.spaceMouse_.hidden = actions.spaceMouse === null;
    const done = button(t('Done'), t('Done: stop carving (Esc)'), actions.done);
    done.classList.add('carve-done');
    this.element = h(
      'section',
      { class: 'carve-bar', 'aria-label': t('Carve') },
      this.rack_,
      h(
        'div',
        { class: 'carve-controls' },
        h(
          'div',
          { class: 'carve-modes', role: 'group', 'aria-label': t('The tip follows') },
          ...modes,
        ),
        this.lean_,
        this.drag_,
        h('div', { class: 'carve-depth' }, h('span', {}, t('Depth')), this.slider_, this.depth_),
        button(
          t('Undo'),
          t('Undo your last stroke (Ctrl+Z, or tap with two fingers)'),
          actions.undo,
        ),
        button(t('Redo'), t('Redo (Ctrl+Shift+Z, or tap with three fingers)'), actions.redo),
        this.spaceMouse_,
        done,
      ),
      this.note_,
    );
  }

  /** Fills the rack. */
  setTools(tools: readonly ToolInfo[]): void {
    const profiles = tools.map(toolProfile);
    const scale = commonScale(profiles);
    this.tools_.clear();
    this.rack_.replaceChildren(
      ...tools.map((tool, n) => {
        const name = toolName(tool);
        const element = h('button', {
          type: 'button',
          class: 'carve-tool',
          title: `${name} ([ and ])`,
        });
        element.innerHTML = silhouette(profiles[n]!, scale); // numbers only
        element.append(h('span', {}, name));
        element.addEventListener('click', () => this.actions.chooseTool(tool.id));
        this.tools_.set(tool.id, element);
        return element;
      }),
    );
  }

  setTool(id: number): void {
    for (const [tool, element] of this.tools_) press(element, tool === id);
    this.tools_.get(id)?.scrollIntoView({ block: 'nearest', inline: 'nearest' });
  }

  setMode(mode: AimMode, leans: boolean): void {
    for (const [one, element] of this.modes_) press(element, one === mode);
    press(this.lean_, leans);
  }

  setDrag(strength: DragStrength): void {
    setText(this.drag_, DRAGS[strength]);
    press(this.drag_, strength !== 'off');
  }

  setSpaceMouse(isThere: boolean): void {
    press(this.spaceMouse_, isThere);
  }

  /** Equal distances on the slider are equal factors of the depth. */
  setDepth(mm: number, range: [least: number, most: number]): void {
    this.depthRange_ = range;
    const [least, most] = range;
    const part = Math.log(mm / least) / Math.log(most / least);
    this.slider_.value = String(Math.round(SLIDER_STEPS * part));
    const text = `${figure(mm)} mm`;
    this.slider_.setAttribute('aria-valuetext', text);
    setText(this.depth_, text);
  }

  /** `isProblem`: something did not work. */
  say(text: string, isProblem = false): void {
    setText(this.note_, text);
    this.note_.classList.toggle('problem', isProblem);
  }

  private sliderMm_(): number {
    const [least, most] = this.depthRange_;
    return least * (most / least) ** (Number(this.slider_.value) / SLIDER_STEPS);
  }
}
