// SPDX-License-Identifier: Apache-2.0
// The user's choices for strokes, in the bar: their symmetry, and the string of a steady hand.

import { signal } from '@preact/signals';
import { recall, remember } from '../strings/memory';
import { t } from '../strings';
import type { Hand } from './hand';
import { nextMirror, TURNS } from './mirror';
import type { Mirror } from './mirror';
import type { ToolSettings } from './tool_settings';

const STEADY = 'steady'; // as it is remembered
const STRINGS_PX = [0, 10, 25, 50, 100];
const DEFAULT_TURNS = 4;

export class StrokeChoices {
  readonly mirror = signal<Mirror>('off');
  readonly stringPx = signal(0);
  private turns_ = DEFAULT_TURNS;

  /** `changes`: the symmetry changes: a stroke ends. */
  constructor(
    private readonly hand: Hand,
    private readonly settings: Pick<ToolSettings, 'togglePlane' | 'nextAxis' | 'nextDrag'>,
    private readonly changes: () => void,
  ) {
    const known = STRINGS_PX.find((px) => String(px) === recall(STEADY));
    this.lead_(known ?? 0);
  }

  /** The actions of keys. */
  readonly keys = {
    nextMirror: () => this.nextMirror(),
    nextString: () => this.nextString(),
    togglePlane: () => this.settings.togglePlane(),
    nextAxis: () => this.settings.nextAxis(),
    nextDrag: () => this.settings.nextDrag(),
  };

  chooseMirror(mirror: Mirror): void {
    this.changes();
    if (typeof mirror === 'number') this.turns_ = mirror;
    this.hand.mirror = mirror;
    this.mirror.value = mirror;
  }

  nextMirror(): void {
    this.chooseMirror(nextMirror(this.mirror.peek(), this.turns_));
  }

  chooseString(px: number): void {
    this.lead_(px);
    remember(STEADY, String(px));
  }

  /** The next length of the string. */
  nextString(): void {
    const at = STRINGS_PX.indexOf(this.stringPx.peek()) + 1;
    this.chooseString(STRINGS_PX[at % STRINGS_PX.length]!);
  }

  private lead_(px: number): void {
    this.hand.steady.lengthPx = px;
    this.stringPx.value = px;
  }
}

function mirrorOf(text: string): Mirror {
  const turns = Number(text);
  return turns > 0 ? turns : (text as Mirror);
}

export function StrokeChoicesView({ choices }: { choices: StrokeChoices }) {
  const { value: mirror } = choices.mirror;
  const { value: stringPx } = choices.stringPx;
  return (
    <>
      <select
        class={mirror === 'off' ? 'carve-choice' : 'carve-choice chosen'}
        aria-label={t('Mirror')}
        title={t('Repeats each stroke in a mirror, or around the vertical axis (M)')}
        value={String(mirror)}
        onChange={({ currentTarget }) => choices.chooseMirror(mirrorOf(currentTarget.value))}
      >
        <option value="off">{t('Mirror: off')}</option>
        {(['x', 'y', 'z'] as const).map((axis) => (
          <option key={axis} value={axis}>
            {t('Mirror: {0}', axis.toUpperCase())}
          </option>
        ))}
        {TURNS.map((turns) => (
          <option key={turns} value={turns}>
            {t('Around: {0}×', turns)}
          </option>
        ))}
      </select>
      <select
        class={stringPx === 0 ? 'carve-choice' : 'carve-choice chosen'}
        aria-label={t('Steady')}
        title={t('Leads the tool on a string behind the pointer, for smooth lines (S)')}
        value={String(stringPx)}
        onChange={({ currentTarget }) => choices.chooseString(Number(currentTarget.value))}
      >
        {STRINGS_PX.map((px) => (
          <option key={px} value={px}>
            {px === 0 ? t('Steady: off') : t('Steady: {0} px', px)}
          </option>
        ))}
      </select>
    </>
  );
}
