// SPDX-License-Identifier: Apache-2.0
// The choice of the block's material. The user's choice is kept; until then the first participants
// decide.

import { useComputed, useSignal, useSignalEffect } from '@preact/signals';
import { t } from '../strings';
import { sessionMaterial, STOCK_MATERIALS } from '../model/materials';
import type { StockMaterialPreset } from '../model/materials';
import type { Participants } from '../model/participants';
import { recall, remember } from '../strings/memory';
import type { Picture } from './picture';

interface MaterialChoiceProps {
  picture: Picture;
  participants: Participants;
}

export function MaterialChoice({ picture, participants }: MaterialChoiceProps) {
  const chosen = useSignal(STOCK_MATERIALS.find(({ name }) => name === recall('look')));
  const suggested = useSignal<StockMaterialPreset | undefined>(undefined);
  useSignalEffect(() => {
    const kinds = participants.carvers().map(({ info }) => info.kind);
    if (kinds.length > 0) suggested.value ??= sessionMaterial(kinds);
  });
  const shown = useComputed(() => chosen.value ?? suggested.value ?? sessionMaterial([]));
  useSignalEffect(() => picture.setMaterial(shown.value));
  return (
    <div class="materials" role="radiogroup" aria-label={t('Material')}>
      {STOCK_MATERIALS.map((preset) => (
        <label key={preset.name} title={preset.name}>
          <input
            type="radio"
            name="material"
            aria-label={preset.name}
            checked={preset === shown.value}
            onChange={() => {
              chosen.value = preset;
              remember('look', preset.name);
            }}
          />
          <span
            class="material"
            style={`background:linear-gradient(135deg, ${preset.core} 55%, ${preset.skin} 56%)`}
          />
        </label>
      ))}
    </div>
  );
}
