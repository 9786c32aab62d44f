// SPDX-License-Identifier: Apache-2.0
// Edits the outline of a tool: by handles in its drawing and by numbers, which follow each other.

import { useSignal } from '@preact/signals';
import { t } from '../../strings';
import {
  pointsOf,
  withoutPoint,
  withPoint,
  withPointBefore,
  withPoints,
} from '../../model/profile_draft';
import type { Edge, ProfilePoint } from '../../model/profile_draft';
import type { ToolInfo } from '../../wire/types';
import { NumberInput } from '../number_input';
import { ProfileDrawing } from './profile_drawing';

const EDGES: readonly [Edge, string][] = [
  ['line', t('line')],
  ['out', t('arc outward')],
  ['in', t('arc inward')],
];
const POINTS_LEAST = 2;

function PointButton(props: { text: string; label: string; press: () => void }) {
  const { text, label, press } = props;
  return (
    <button
      type="button"
      class="button quiet-button"
      aria-label={label}
      title={label}
      onClick={press}
    >
      {text}
    </button>
  );
}

interface PointRowProps {
  points: readonly ProfilePoint[];
  /** The index of the point of this row. */
  n: number;
  set: (points: ProfilePoint[]) => void;
}

function PointRow({ points, n, set }: PointRowProps) {
  const { r, z, edge, radius } = points[n]!;
  const name = n + 1;
  const change = (part: Partial<ProfilePoint>): void => set(withPoint(points, n, part));
  return (
    <li>
      <span>
        {'⌀/2 '}
        <NumberInput
          label={t('Radius of point {0}, mm', name)}
          value={r}
          set={(value) => change({ r: value })}
        />
      </span>
      <span>
        {'↑ '}
        <NumberInput
          label={t('Height of point {0}, mm', name)}
          value={z}
          set={(value) => change({ z: value })}
        />
      </span>
      <select
        class="select"
        aria-label={t('Line or arc to point {0}', name)}
        hidden={n === 0}
        value={edge}
        onChange={({ currentTarget }) => change({ edge: currentTarget.value as Edge })}
      >
        {EDGES.map(([value, text]) => (
          <option key={value} value={value}>
            {text}
          </option>
        ))}
      </select>
      <NumberInput
        label={t('Radius of the arc to point {0}, mm', name)}
        value={radius}
        set={(value) => change({ radius: value })}
        hidden={edge === 'line'}
      />
      {n > 0 && (
        <PointButton
          text="+"
          label={t('Add a point before point {0}', name)}
          press={() => set(withPointBefore(points, n))}
        />
      )}
      {n > 0 && points.length > POINTS_LEAST && (
        <PointButton
          text="−"
          label={t('Remove point {0}', name)}
          press={() => set(withoutPoint(points, n))}
        />
      )}
    </li>
  );
}

interface ProfileEditorProps {
  tool: ToolInfo;
  /** Called with the tool with its new outline. */
  changed: (tool: ToolInfo) => void;
}

export function ProfileEditor({ tool, changed }: ProfileEditorProps) {
  // The points that the user has entered; an outline may not have all of them.
  const points = useSignal<readonly ProfilePoint[]>(pointsOf(tool) ?? []);
  const set = (to: ProfilePoint[]): void => {
    points.value = to;
    changed(withPoints(tool, to));
  };
  const { value } = points;
  return (
    <div class="profile-editor">
      <ProfileDrawing
        tool={tool}
        points={value}
        moved={(n, r, z) => set(withPoint(points.peek(), n, { r, z }))}
      />
      <ol class="profile-points" aria-label={t('Points from the tip up')}>
        {value.map((_, n) => (
          // Other points: other rows.
          <PointRow key={`${n} ${value.length}`} points={value} n={n} set={set} />
        ))}
      </ol>
    </div>
  );
}
