// SPDX-License-Identifier: Apache-2.0
// The comparison of the block with a part: colors for the deviation of every place, figures of the
// whole surface, and the worst places.

import { t } from '../../strings';
import {
  distancesFrom,
  listTargets,
  POINTS_MAX,
  removeTarget,
  setTarget,
  surveyDeviation,
} from '../../link/targets';
import type { TargetPart, UnitAnswer } from '../../link/targets';
import { rangeOf } from '../../model/deviation';
import type { DeviationPlace, DeviationSurvey } from '../../model/deviation';
import { paintedEdge } from '../../model/refine';
import type { LengthUnit } from '../../model/measure';
import type { Bounds } from '../../model/session';
import { plus } from '../../model/vector';
import { MeasureView } from '../../view/inspect/measure_view';
import { PaintedMaterial } from '../../view/inspect/painted_material';
import { PaintedView, trianglesOf } from '../../view/inspect/painted_view';
import type { Viewer } from '../../view/viewer';
import type { Vec3 } from '../../wire/types';
import { Vector3 } from 'three';
import type { CutNote } from './cut_note';
import { DeviationControls } from './deviation_controls';
import { signed } from './deviation_plot';
import type { InspectHost } from './host';
import { PartUnit } from './part_unit';
import { partTolerance, rememberPartTolerance } from '../part_tolerance';

/** While the block changes it is surveyed at most so often. */
const SURVEY_EVERY_MS = 5000;
const ARM_PX = 36;

/** How far a part has to be moved to be in the middle of the block, with its top at the block's. */
export function shiftInto(part: Bounds, block: Bounds): Vec3 {
  const between = (n: 0 | 1): number =>
    (block.min[n] + block.max[n] - part.min[n] - part.max[n]) / 2;
  return [between(0), between(1), block.max[2] - part.max[2]];
}

/** Whether no place of a part is in the block. */
export function isOutside(part: Bounds, block: Bounds): boolean {
  return ([0, 1, 2] as const).some(
    (n) => part.max[n] <= block.min[n] || part.min[n] >= block.max[n],
  );
}

export class Comparing {
  /** The colors are shown, in place of others. */
  chosen: () => void = () => undefined;
  private readonly controls_ = new DeviationControls({
    choose: (name) => this.choose_(name),
    added: (file) => void this.add_(file, [0, 0, 0]),
    remove: (name) => void this.remove_(name),
    center: () => this.center_(),
    tolerance: (mm) => this.setTolerance_(mm),
    place: (place) => this.goTo_(place),
  });
  private readonly unit_ = new PartUnit((answer) => this.answer_(answer));
  private readonly marker_: MeasureView;
  private parts_: readonly TargetPart[] = [];
  private chosen_: TargetPart | null = null;
  /** The file that was sent last, and its unit, in case it has to be moved. */
  private sent_: { file: File; as: UnitAnswer | undefined } | null = null;
  private painted_: PaintedView | null = null;
  private readonly material_ = new PaintedMaterial();
  private stop_ = new AbortController();
  private survey_: DeviationSurvey | null = null;
  private surveyed_ = '';
  private surveyMs_ = -Infinity;
  private isSurveying_ = false;
  private place_: DeviationPlace | null = null;
  private toleranceMm_ = 0;
  private units_: LengthUnit = 'mm';

  constructor(
    private readonly viewer: Viewer,
    private readonly host: InspectHost,
    private readonly session: string,
    private readonly bounds: () => Bounds,
    private readonly note: CutNote,
  ) {
    this.controls_.places.append(note.element);
    this.controls_.hints.append(this.unit_.element);
    this.marker_ = new MeasureView(viewer, host.overlay);
  }

  get element(): HTMLElement {
    return this.controls_.element;
  }

  /** Shows a sentence where the part's are, until there is another one. */
  say(text: string): void {
    this.controls_.say(text);
  }

  /** The panel was opened: others may have added parts. */
  async open(): Promise<void> {
    const { welcome } = this.host.model;
    this.toleranceMm_ = partTolerance(welcome?.pitch_mm);
    this.controls_.say('');
    await this.list_();
    if (this.parts_.length === 0)
      this.controls_.say(
        this.may_('run_programs')
          ? t("Add a model of the finished part, in the block's coordinates, or drop it here")
          : t('Nobody has added a part to compare with yet'),
      );
  }

  close(): void {
    this.choose_(null);
  }

  /** Called some times a second while the panel is open. */
  update(nowMs: number): void {
    if (!this.painted_ || !this.chosen_) return;
    this.painted_.update();
    this.surveyIfChanged_(nowMs);
    this.sayState_();
  }

  setUnits(units: LengthUnit): void {
    this.units_ = units;
    this.show_();
  }

  private may_(what: string): boolean {
    return this.host.model.welcome?.may?.includes(what) ?? true;
  }

  private async list_(): Promise<void> {
    try {
      this.parts_ = await listTargets(this.session);
    } catch (problem) {
      this.controls_.say((problem as Error).message);
    }
    this.showParts_();
  }

  private showParts_(): void {
    this.controls_.showParts(this.parts_, this.chosen_?.name ?? null, this.may_('run_programs'));
  }

  private async add_(file: File, shift: Vec3, as?: UnitAnswer): Promise<void> {
    this.choose_(null);
    this.controls_.say(t('Uploading {0}…', file.name));
    try {
      const part = await setTarget(this.session, file, shift, as);
      this.sent_ = { file, as };
      await this.list_();
      this.choose_(part.name);
      this.unit_.ask(part);
    } catch (problem) {
      this.controls_.say((problem as Error).message);
    }
  }

  private async remove_(name: string): Promise<void> {
    this.choose_(null);
    try {
      await removeTarget(this.session, name);
    } catch (problem) {
      this.controls_.say((problem as Error).message);
    }
    await this.list_();
  }

  /** Sends the part again in a unit, at its origin: its place in mm was that of another size. */
  private answer_(as: UnitAnswer): void {
    if (this.sent_) void this.add_(this.sent_.file, [0, 0, 0], as);
  }

  private center_(): void {
    const { chosen_: part, sent_: sent } = this;
    if (!part || !sent) return;
    const [x, y, z] = shiftInto({ min: part.min_mm, max: part.max_mm }, this.bounds());
    const [fromX, fromY, fromZ] = part.shift_mm;
    void this.add_(sent.file, [x + fromX, y + fromY, z + fromZ], sent.as);
  }

  private choose_(name: string | null): void {
    this.stop_.abort();
    this.stop_ = new AbortController();
    this.painted_?.dispose();
    this.painted_ = null;
    this.survey_ = null;
    this.surveyed_ = '';
    this.surveyMs_ = -Infinity;
    this.isSurveying_ = false;
    this.unit_.ask(null);
    this.mark_(null);
    this.chosen_ = this.parts_.find((part) => part.name === name) ?? null;
    if (this.chosen_) {
      this.chosen();
      this.painted_ = this.paint_(this.chosen_.name);
    }
    this.controls_.say('');
    this.showParts_();
    this.show_();
  }

  private paint_(name: string): PaintedView {
    const { signal } = this.stop_;
    const limitMm = paintedEdge(this.host.model.welcome?.pitch_mm ?? 0, this.bounds());
    return new PaintedView(
      this.viewer,
      {
        material: this.material_.material,
        trianglesOf: (tile) => trianglesOf(tile, limitMm),
        questionsOf: ({ positions }) => positions,
        numbers: 3,
        questionsMax: POINTS_MAX,
        ask: (points) => distancesFrom(this.session, name, points, signal),
        paint: (triangles, answers) => ({ ...triangles, values: Float32Array.from(answers) }),
      },
      (problem) => this.fail_(problem),
    );
  }

  private fail_(problem: unknown): void {
    this.choose_(null);
    this.controls_.say((problem as Error).message);
  }

  private surveyIfChanged_(nowMs: number): void {
    const { state } = this.host.model;
    if (!state || this.isSurveying_ || nowMs - this.surveyMs_ < SURVEY_EVERY_MS) return;
    const at = state.at?.record ?? null;
    const key = `${state.state_hash} ${at}`;
    if (key === this.surveyed_) return;
    this.surveyed_ = key;
    this.surveyMs_ = nowMs;
    void this.ask_(this.chosen_!.name, at, this.stop_.signal);
  }

  private async ask_(name: string, at: number | null, signal: AbortSignal): Promise<void> {
    this.isSurveying_ = true;
    try {
      this.survey_ = await surveyDeviation(this.session, name, at, signal);
      this.show_();
    } catch (problem) {
      if (!signal.aborted) this.fail_(problem);
    }
    if (!signal.aborted) this.isSurveying_ = false;
  }

  private sayState_(): void {
    const { chosen_: part, painted_: painted } = this;
    if (!part || !painted) return;
    if (isOutside({ min: part.min_mm, max: part.max_mm }, this.bounds())) {
      const canMove = this.sent_?.file.name === part.name;
      this.controls_.say(t('The part lies outside the block: their origins differ'), canMove);
    } else if (painted.share < 1 || !this.survey_) {
      this.controls_.say(t('Measuring… {0} %', 10 * Math.floor(10 * painted.share)));
    } else if (part.fault) {
      this.controls_.say(
        t('The part is not closed, so “too deep” and “left over” may be mixed up: {0}', part.fault),
      );
    } else {
      this.controls_.say('');
    }
  }

  private setTolerance_(mm: number): void {
    this.toleranceMm_ = mm;
    rememberPartTolerance(mm);
    this.mark_(null);
    this.show_();
  }

  private show_(): void {
    this.controls_.showSurvey(this.survey_, this.toleranceMm_, this.units_);
    const range = this.survey_ ? rangeOf(this.survey_, this.toleranceMm_) : 10 * this.toleranceMm_;
    this.material_.setScale(this.toleranceMm_, range);
    this.viewer.touch();
    if (this.place_) this.mark_(this.place_);
  }

  private mark_(place: DeviationPlace | null): void {
    this.place_ = place;
    if (!place) {
      this.note.say('');
      this.marker_.show([], []);
      return;
    }
    const { at_mm: at, normal, mm } = place;
    const end = plus(at, normal, ARM_PX * this.viewer.pixelMm(new Vector3(...at)));
    const text = `${signed(mm, this.units_)} ${this.units_}`;
    this.marker_.show([{ line: [at, end], place: end, text }], []);
  }

  /** Tells who cut a place, and looks at it from outside, a little from where the picture is seen now. */
  private goTo_(place: DeviationPlace): void {
    const { rig } = this.viewer;
    const at = new Vector3(...place.at_mm);
    const from = rig.camera.position.clone().sub(rig.controls.target).normalize();
    from
      .multiplyScalar(0.7)
      .add(new Vector3(...place.normal))
      .normalize();
    rig.view(at.clone().addScaledVector(from, 0.7 * rig.closeMm), at, performance.now());
    this.mark_(place);
    void this.note.ask(place.at_mm, place.normal);
  }
}
