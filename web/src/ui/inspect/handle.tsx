// SPDX-License-Identifier: Apache-2.0
// The handle of the section plane in the picture: dragged along the plane's normal, or moved by the
// arrow keys.

import { signal } from '@preact/signals';
import { useRef } from 'preact/hooks';
import { t } from '../../strings';
import { Vector3 } from 'three';
import type { Camera } from 'three';
import type { Plane } from '../../model/section';
import type { Vec3 } from '../../wire/types';

/** Of the plane's normal: seen more steeply from in front, no drag could say how far. */
const LEAST_SLOPE = 0.08;

/** Where the handle is in the picture, CSS pixels and radians. */
interface Place {
  x: number;
  y: number;
  turn: number;
}

export class Handle {
  /** Null: there is no plane, or it is seen from in front. */
  readonly place = signal<Place | null>(null);
  /** Where a millimeter along the normal is in the picture, CSS pixels. */
  perMm: readonly [number, number] = [0, -1];

  /**
   * Puts it where a point of the plane is in a picture of this size, a pixel of which is `pixelMm`
   * there.
   */
  update(
    { normal }: Plane,
    anchor: Vec3,
    camera: Camera,
    [width, height]: readonly [number, number],
    pixelMm: number,
  ): void {
    const seen = (at: Vector3): [number, number] => {
      const { x, y } = at.project(camera);
      return [((x + 1) / 2) * width, ((1 - y) / 2) * height];
    };
    const [x, y] = seen(new Vector3(...anchor));
    const [nextX, nextY] = seen(new Vector3(...normal).add(new Vector3(...anchor)));
    this.perMm = [nextX - x, nextY - y];
    const isSteep = Math.hypot(...this.perMm) * pixelMm < LEAST_SLOPE;
    this.place.value = isSteep ? null : { x, y, turn: Math.atan2(nextY - y, nextX - x) };
  }
}

interface HandleViewProps {
  handle: Handle;
  /** Null: there is no section. */
  plane: Plane | null;
  /** The text that is read out. */
  text: string;
  /** The step of an arrow key, mm. */
  stepMm: number;
  /** Called with the plane's new offset. */
  moved: (offset: number) => void;
}

const STEPS: Partial<Record<string, number>> = {
  ArrowUp: 1,
  ArrowRight: 1,
  ArrowDown: -1,
  ArrowLeft: -1,
};

export function HandleView({ handle, plane, text, stepMm, moved }: HandleViewProps) {
  const drag = useRef<{ x: number; y: number; offset: number } | null>(null);
  const { value: place } = handle.place;
  const end = (): void => void (drag.current = null);
  const { x = 0, y = 0, turn = 0 } = place ?? {};
  return (
    <button
      type="button"
      class="section-handle"
      role="slider"
      aria-label={t('Section plane')}
      aria-orientation="vertical"
      aria-valuenow={plane ? Number(plane.offset.toFixed(3)) : undefined}
      aria-valuetext={text}
      title={t('Drag the section plane')}
      hidden={plane === null || place === null}
      style={
        `transform:translate(-50%, -50%) translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) ` +
        `rotate(${turn.toFixed(3)}rad)`
      }
      onPointerDown={({ currentTarget, pointerId, clientX, clientY }) => {
        if (!plane) return;
        currentTarget.setPointerCapture(pointerId);
        drag.current = { x: clientX, y: clientY, offset: plane.offset };
      }}
      onPointerMove={({ clientX, clientY }) => {
        if (!drag.current) return;
        const [alongX, alongY] = handle.perMm;
        const { x: fromX, y: fromY, offset } = drag.current;
        const along = (clientX - fromX) * alongX + (clientY - fromY) * alongY;
        moved(offset + along / (alongX * alongX + alongY * alongY));
      }}
      onPointerUp={end}
      onPointerCancel={end}
      onKeyDown={(event) => {
        const sign = STEPS[event.key];
        if (sign === undefined || !plane) return;
        event.preventDefault();
        event.stopPropagation();
        moved(plane.offset + sign * stepMm * (event.shiftKey ? 10 : 1));
      }}
    />
  );
}
