// SPDX-License-Identifier: Apache-2.0
// Measuring: points are pressed in the picture until there are enough, and the measure is kept.

import { batch, effect, signal } from '@preact/signals';
import type { ReadonlySignal } from '@preact/signals';
import { t } from '../../strings';
import {
  angleOf,
  depthOf,
  distanceOf,
  POINTS_OF,
  radiusOf,
  thicknessOf,
  valueText,
} from '../../model/measure';
import type { LengthUnit, Measure, MeasureKind } from '../../model/measure';
import { stockBounds } from '../../model/session';
import { thicknessAt } from '../../model/surface';
import type { DisplayedSurface } from '../../view/displayed_surface';
import { MeasureView } from '../../view/inspect/measure_view';
import type { Viewer } from '../../view/viewer';
import { Vector3 } from 'three';
import { hintOf } from './measure_hint';
import type { InspectHost } from './host';
import type { Picked } from './picker';

const ARM_PX = 40; // of the normals that an angle shows

export class Measuring {
  /** Something is measured. */
  chosen: () => void = () => undefined;
  private readonly view_: MeasureView;
  /** Null: nothing is measured. */
  readonly kind = signal<MeasureKind | null>(null);
  readonly measures = signal<readonly Measure[]>([]);
  /** The next step, or why there is no result. */
  readonly hint = signal('');
  private readonly pressed_ = signal<readonly Picked[]>([]);

  constructor(
    private readonly viewer: Viewer,
    private readonly surface: DisplayedSurface,
    private readonly host: InspectHost,
    private readonly units: ReadonlySignal<LengthUnit>,
    readonly pick: (x: number, y: number) => Picked | null,
  ) {
    this.view_ = new MeasureView(viewer, host.overlay);
    effect(() => this.draw_());
  }

  get isOn(): boolean {
    return this.kind.value !== null;
  }

  choose(kind: MeasureKind | null): void {
    if (kind) this.chosen();
    this.view_.point(null);
    batch(() => {
      this.kind.value = kind;
      this.pressed_.value = [];
      this.hint.value = hintOf(kind, 0);
      this.host.shell.isMeasuring.value = kind !== null;
    });
  }

  hover(x: number, y: number): void {
    const kind = this.kind.peek();
    if (!kind) return;
    const picked = this.pick(x, y);
    const isFree = kind === 'thickness' || kind === 'angle';
    this.view_.point(picked && (isFree ? { kind: 'face', point: picked.point } : picked.snapped));
  }

  press(picked: Picked): void {
    const kind = this.kind.peek();
    if (!kind) return;
    const pressed = [...this.pressed_.peek(), picked];
    const isEnough = pressed.length === POINTS_OF[kind];
    const measure = isEnough ? this.measure_(kind, pressed) : null;
    batch(() => {
      this.pressed_.value = isEnough ? [] : pressed;
      this.hint.value =
        isEnough && !measure
          ? t(
              'No result: the points lie on one line, or the wall has no back side. Pick other points.',
            )
          : hintOf(kind, this.pressed_.value.length);
      if (measure) this.measures.value = [...this.measures.peek(), measure];
    });
  }

  remove(measure: Measure): void {
    this.measures.value = this.measures.peek().filter((one) => one !== measure);
  }

  clear(): void {
    this.measures.value = [];
  }

  private measure_(kind: MeasureKind, pressed: readonly Picked[]): Measure | null {
    const [a, b, c] = pressed as [Picked, Picked, Picked];
    const { welcome } = this.host.model;
    switch (kind) {
      case 'distance':
        return distanceOf(a.snapped.point, b.snapped.point);
      case 'thickness': {
        const wall = thicknessAt(this.surface.pieces, a.point, a.normal);
        return wall && thicknessOf(a.point, wall.end);
      }
      case 'depth':
        return depthOf(a.snapped.point, stockBounds(welcome!.stock).max[2]);
      case 'radius':
        return radiusOf(a.snapped.point, b.snapped.point, c.snapped.point);
      case 'angle':
        return angleOf(a, b, ARM_PX * this.viewer.pixelMm(new Vector3(...a.point)));
    }
  }

  private draw_(): void {
    this.view_.show(
      this.measures.value.map((measure) => ({
        line: measure.line,
        place: measure.place,
        text: valueText(measure, this.units.value),
      })),
      this.pressed_.value.map(({ snapped }) => snapped.point),
    );
  }
}
