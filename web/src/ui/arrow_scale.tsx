// SPDX-License-Identifier: Apache-2.0
// The force and the torque of the longest arrows.

import type { ReadonlySignal } from '@preact/signals';
import type { SessionModel } from '../model/session';
import { figure } from './format';
import type { Picture } from './picture';

interface ArrowScaleProps {
  model: SessionModel;
  picture: Picture;
  colors: { force: string; torque: string };
  nowMs: ReadonlySignal<number>;
}

export function ArrowScale({ model, picture, colors, nowMs }: ArrowScaleProps) {
  const hasCarvers = model.participants.carvers().length > 0;
  const viewer = picture.arrowsVisible && hasCarvers ? picture.viewer : null;
  const scale = nowMs.value > 0 ? viewer?.arrowScale : undefined; // sampled
  return (
    <div class="arrow-scale" aria-hidden="true" hidden={viewer === null}>
      <span style={`--line:${colors.force}`}>{scale && `${figure(scale.forceFullN)} N`}</span>
      <span style={`--line:${colors.torque}`}>
        {scale && `${figure(scale.torqueFullNmm)} N·mm`}
      </span>
    </div>
  );
}
