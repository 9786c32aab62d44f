// SPDX-License-Identifier: Apache-2.0
// The choice of the block's material. The user's choice is kept; until then the kind of session
// decides.

import { t } from '../strings';
import { sessionMaterial, STOCK_MATERIALS } from '../model/materials';
import type { StockMaterialPreset } from '../model/materials';
import type { ParticipantKind } from '../wire/types';
import { h } from './dom';
import { recall, remember } from '../strings/memory';

export class MaterialChoice {
  readonly element = h('div', {
    class: 'materials',
    role: 'radiogroup',
    'aria-label': t('Material'),
  });
  private readonly inputs_ = new Map<StockMaterialPreset, HTMLInputElement>();
  private decided_ = false;

  constructor(private readonly chosen: (preset: StockMaterialPreset) => void) {
    for (const preset of STOCK_MATERIALS) this.add_(preset);
    const saved = STOCK_MATERIALS.find(({ name }) => name === recall('look'));
    this.decided_ = saved !== undefined;
    this.set_(saved ?? sessionMaterial([]));
  }

  /** Takes the kinds of those who carve; the first ones decide. */
  suggest(kinds: readonly ParticipantKind[]): void {
    if (this.decided_ || kinds.length === 0) return;
    this.decided_ = true;
    this.set_(sessionMaterial(kinds));
  }

  private add_(preset: StockMaterialPreset): void {
    const input = h('input', { type: 'radio', name: 'material', 'aria-label': preset.name });
    input.addEventListener('change', () => {
      this.decided_ = true;
      remember('look', preset.name);
      this.chosen(preset);
    });
    const swatch = h('span', {
      class: 'material',
      style: `background:linear-gradient(135deg, ${preset.core} 55%, ${preset.skin} 56%)`,
    });
    this.inputs_.set(preset, input);
    this.element.append(h('label', { title: preset.name }, input, swatch));
  }

  private set_(preset: StockMaterialPreset): void {
    this.inputs_.get(preset)!.checked = true;
    this.chosen(preset);
  }
}
