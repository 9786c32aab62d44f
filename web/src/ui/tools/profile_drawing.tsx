// SPDX-License-Identifier: Apache-2.0
// The outline of a tool, large, with a handle at each point. The number fields next to it state the
// same for users who do not drag.

import { useRef } from 'preact/hooks';
import { snapped } from '../../model/profile_draft';
import type { ProfilePoint } from '../../model/profile_draft';
import { toolProfile } from '../../model/tool_profile';
import type { OutlinePoint, ToolProfile } from '../../model/tool_profile';
import type { ToolInfo } from '../../wire/types';

const WIDTH = 220;
const HEIGHT = 280;
const MARGIN = 16;
const HANDLE = 6;
const TARGET = 12; // where a handle is caught

type Place = [x: number, y: number];

/** Units of the drawing per mm, with which all points fit. */
function scaleOf({ radiusMm }: ToolProfile, points: readonly ProfilePoint[]): number {
  const high = Math.max(1, ...points.map(({ z }) => z));
  const wide = Math.max(1, radiusMm, ...points.map(({ r }) => r));
  return Math.min((HEIGHT - 2 * MARGIN) / high, (WIDTH / 2 - MARGIN) / wide);
}

function placeOf(r: number, z: number, scale: number): Place {
  return [WIDTH / 2 + r * scale, HEIGHT - MARGIN - z * scale];
}

function pathOf(right: readonly OutlinePoint[], scale: number): string {
  const left = right.map(([r, z]): OutlinePoint => [-r, z]).reverse();
  const words = [...right, ...left].map(([r, z]) =>
    placeOf(r, z, scale)
      .map((value) => value.toFixed(1))
      .join(),
  );
  return `M${words.join('L')}Z`;
}

/** The place of a pointer, units of the drawing. */
function pointerIn(event: PointerEvent & { currentTarget: Element }): Place {
  const { left, top, width, height } = event.currentTarget.getBoundingClientRect();
  return [((event.clientX - left) / width) * WIDTH, ((event.clientY - top) / height) * HEIGHT];
}

/** The point whose handle is at a place; null: none. */
function pointAt([x, y]: Place, points: readonly ProfilePoint[], scale: number): number | null {
  const far = points.map(({ r, z }) => {
    const [px, py] = placeOf(r, z, scale);
    return Math.hypot(px - x, py - y);
  });
  const nearest = far.indexOf(Math.min(...far));
  return far[nearest]! <= TARGET ? nearest : null;
}

interface ProfileDrawingProps {
  tool: ToolInfo;
  points: readonly ProfilePoint[];
  /** A point was dragged to (r, z), mm. */
  moved: (n: number, r: number, z: number) => void;
}

export function ProfileDrawing({ tool, points, moved }: ProfileDrawingProps) {
  const dragged = useRef<number | null>(null);
  const scale = useRef(1); // stays while a point is dragged
  const profile = toolProfile(tool);
  if (dragged.current === null) scale.current = scaleOf(profile, points);
  const { current: perMm } = scale;
  const end = (): void => void (dragged.current = null);
  return (
    <div class="profile-drawing" aria-hidden="true">
      <svg
        viewBox={`0 0 ${WIDTH} ${HEIGHT}`}
        width={WIDTH}
        height={HEIGHT}
        onPointerDown={(event) => {
          dragged.current = pointAt(pointerIn(event), points, perMm);
          if (dragged.current === null) return;
          event.currentTarget.setPointerCapture(event.pointerId);
          event.preventDefault();
        }}
        onPointerMove={(event) => {
          if (dragged.current === null) return;
          const [x, y] = pointerIn(event);
          const r = snapped((x - WIDTH / 2) / perMm);
          const z = snapped((HEIGHT - MARGIN - y) / perMm);
          moved(dragged.current, Math.max(0, r), Math.max(0, z));
        }}
        onPointerUp={end}
        onPointerCancel={end}
      >
        <path class="cutter" d={pathOf(profile.pieces.flat(), perMm)} />
        <line class="axis" x1={WIDTH / 2} x2={WIDTH / 2} y1={0} y2={HEIGHT} />
        {points.map(({ r, z }, n) => {
          const [cx, cy] = placeOf(r, z, perMm);
          return (
            <circle
              key={n}
              class="handle"
              data-n={String(n)}
              r={HANDLE}
              cx={cx.toFixed(1)}
              cy={cy.toFixed(1)}
            />
          );
        })}
      </svg>
    </div>
  );
}
