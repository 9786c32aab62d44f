// SPDX-License-Identifier: Apache-2.0
// Measuring: points are pressed in the picture until there are enough, and the measure is kept.

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
import { MeasureControls } from './measure_controls';
import type { InspectHost } from './host';
import type { Picked } from './picker';

const ARM_PX = 40; // of the normals that an angle shows

export class Measuring {
  /** Something is measured. */
  chosen: () => void = () => undefined;
  private readonly view_: MeasureView;
  private readonly controls_ = new MeasureControls({
    choose: (kind) => this.choose(kind),
    remove: (measure) => this.keep_(this.measures_.filter((one) => one !== measure)),
    clear: () => this.clear(),
  });
  private kind_: MeasureKind | null = null;
  private pressed_: Picked[] = [];
  private measures_: readonly Measure[] = [];
  private units_: LengthUnit = 'mm';

  constructor(
    private readonly viewer: Viewer,
    private readonly surface: DisplayedSurface,
    private readonly host: InspectHost,
    readonly pick: (x: number, y: number) => Picked | null,
  ) {
    this.view_ = new MeasureView(viewer, host.overlay);
  }

  get element(): HTMLElement {
    return this.controls_.element;
  }

  get isOn(): boolean {
    return this.kind_ !== null;
  }

  choose(kind: MeasureKind | null): void {
    if (kind) this.chosen();
    this.kind_ = kind;
    this.pressed_ = [];
    this.view_.point(null);
    this.host.canvas.classList.toggle('measures', kind !== null);
    this.controls_.showKind(kind, 0);
    this.draw_();
  }

  hover(x: number, y: number): void {
    if (!this.kind_) return;
    const picked = this.pick(x, y);
    const isFree = this.kind_ === 'thickness' || this.kind_ === 'angle';
    this.view_.point(picked && (isFree ? { kind: 'face', point: picked.point } : picked.snapped));
  }

  press(picked: Picked): void {
    if (!this.kind_) return;
    this.pressed_.push(picked);
    if (this.pressed_.length === POINTS_OF[this.kind_]) {
      const measure = this.measure_(this.kind_);
      this.pressed_ = [];
      this.controls_.showKind(this.kind_, 0);
      if (measure) this.keep_([...this.measures_, measure]);
      else
        this.controls_.say(
          t(
            'No result: the points lie on one line, or the wall has no back side. Pick other points.',
          ),
        );
    } else {
      this.controls_.showKind(this.kind_, this.pressed_.length);
    }
    this.draw_();
  }

  clear(): void {
    this.keep_([]);
  }

  setUnits(units: LengthUnit): void {
    this.units_ = units;
    this.keep_(this.measures_);
  }

  private measure_(kind: MeasureKind): Measure | null {
    const [a, b, c] = this.pressed_ as [Picked, Picked, Picked];
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

  private keep_(measures: readonly Measure[]): void {
    this.measures_ = measures;
    this.controls_.showMeasures(measures, this.units_);
    this.draw_();
  }

  private draw_(): void {
    this.view_.show(
      this.measures_.map((measure) => ({
        line: measure.line,
        place: measure.place,
        text: valueText(measure, this.units_),
      })),
      this.pressed_.map(({ snapped }) => snapped.point),
    );
  }
}
