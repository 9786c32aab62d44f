// SPDX-License-Identifier: Apache-2.0
// The comparison of the block with a part: colors for the deviation of every place, figures of the
// whole surface, and the worst places.

import { effect, signal } from '@preact/signals';
import type { ReadonlySignal } from '@preact/signals';
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
import { signed } from './deviation_plot';
import type { InspectHost } from './host';
import { PartUnit } from './part_unit';
import { sentence } from '../format';
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
  hasChosen: () => void = () => undefined;
  /** The state in a sentence; `canCenter`: the part can be moved into the block. */
  readonly hint = signal({ text: '', canCenter: false });
  readonly toleranceMm = signal(0);
  /** The newest survey of the chosen part; null: none yet. */
  readonly survey = signal<DeviationSurvey | null>(null);
  readonly unit = new PartUnit((as) => this.sendAs_(as));
  private readonly marker_: MeasureView;
  private readonly parts_ = signal<readonly TargetPart[]>([]);
  private readonly chosen_ = signal<TargetPart | null>(null);
  /** The file that was sent last, and its unit, in case it has to be moved. */
  private sent_: { file: File; as: UnitAnswer | undefined } | null = null;
  private painted_: PaintedView | null = null;
  private readonly material_ = new PaintedMaterial();
  private stop_ = new AbortController();
  private surveyed_ = '';
  private surveyMs_ = -Infinity;
  private isSurveying_ = false;
  private readonly place_ = signal<DeviationPlace | null>(null);

  constructor(
    private readonly viewer: Viewer,
    private readonly host: InspectHost,
    private readonly session: string,
    private readonly bounds: () => Bounds,
    private readonly units: ReadonlySignal<LengthUnit>,
    readonly note: CutNote,
  ) {
    this.marker_ = new MeasureView(viewer, host.overlay);
    effect(() => this.showScale_());
    effect(() => this.showMark_());
  }

  // The properties are tracked as signals are.

  get parts(): readonly TargetPart[] {
    return this.parts_.value;
  }

  /** The part that the block is compared with; null: none. */
  get chosen(): TargetPart | null {
    return this.chosen_.value;
  }

  /** Whether this viewer may add and remove parts. */
  get mayChange(): boolean {
    return this.host.model.welcome?.may?.includes('run_programs') ?? true;
  }

  /** Shows a sentence where the part's are, until there is another one. */
  say(text: string, canCenter = false): void {
    const hint = { text: text === '' ? '' : sentence(text), canCenter };
    const { text: before, canCenter: couldCenter } = this.hint.peek();
    if (hint.text !== before || canCenter !== couldCenter) this.hint.value = hint;
  }

  /** The panel was opened: others may have added parts. */
  async open(): Promise<void> {
    const { welcome } = this.host.model;
    this.toleranceMm.value = partTolerance(welcome?.pitch_mm);
    this.say('');
    await this.list_();
    if (this.parts.length === 0)
      this.say(
        this.mayChange
          ? t("Add a model of the finished part, in the block's coordinates, or drop it here")
          : t('Nobody has added a part to compare with yet'),
      );
  }

  close(): void {
    this.choose(null);
  }

  /** Called some times a second while the panel is open. */
  update(nowMs: number): void {
    if (!this.painted_ || !this.chosen_.peek()) return;
    this.painted_.update();
    this.surveyIfChanged_(nowMs);
    this.sayState_();
  }

  private async list_(): Promise<void> {
    try {
      this.parts_.value = await listTargets(this.session);
    } catch (problem) {
      this.say((problem as Error).message);
    }
  }

  /** Adds a part, and compares with it. */
  add(file: File): void {
    void this.add_(file, [0, 0, 0]);
  }

  private async add_(file: File, shift: Vec3, as?: UnitAnswer): Promise<void> {
    this.choose(null);
    this.say(t('Uploading {0}…', file.name));
    try {
      const part = await setTarget(this.session, file, shift, as);
      this.sent_ = { file, as };
      await this.list_();
      this.choose(part.name);
      this.unit.ask(part);
    } catch (problem) {
      this.say((problem as Error).message);
    }
  }

  async remove(name: string): Promise<void> {
    this.choose(null);
    try {
      await removeTarget(this.session, name);
    } catch (problem) {
      this.say((problem as Error).message);
    }
    await this.list_();
  }

  /** Sends the part again in a unit, at its origin: its place in mm was that of another size. */
  private sendAs_(as: UnitAnswer): void {
    if (this.sent_) void this.add_(this.sent_.file, [0, 0, 0], as);
  }

  /** Moves the chosen part into the block. */
  center(): void {
    const { sent_: sent } = this;
    const part = this.chosen_.peek();
    if (!part || !sent) return;
    const [x, y, z] = shiftInto({ min: part.min_mm, max: part.max_mm }, this.bounds());
    const [fromX, fromY, fromZ] = part.shift_mm;
    void this.add_(sent.file, [x + fromX, y + fromY, z + fromZ], sent.as);
  }

  /** Compares with a part; null: with none. */
  choose(name: string | null): void {
    this.stop_.abort();
    this.stop_ = new AbortController();
    this.painted_?.dispose();
    this.painted_ = null;
    this.survey.value = null;
    this.surveyed_ = '';
    this.surveyMs_ = -Infinity;
    this.isSurveying_ = false;
    this.unit.ask(null);
    this.mark_(null);
    const chosen = this.parts_.peek().find((part) => part.name === name) ?? null;
    this.chosen_.value = chosen;
    if (chosen) {
      this.hasChosen();
      this.painted_ = this.paint_(chosen.name);
    }
    this.say('');
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
    this.choose(null);
    this.say((problem as Error).message);
  }

  private surveyIfChanged_(nowMs: number): void {
    const { state } = this.host.model;
    if (!state || this.isSurveying_ || nowMs - this.surveyMs_ < SURVEY_EVERY_MS) return;
    const at = state.at?.record ?? null;
    const key = `${state.state_hash} ${at}`;
    if (key === this.surveyed_) return;
    this.surveyed_ = key;
    this.surveyMs_ = nowMs;
    void this.ask_(this.chosen_.peek()!.name, at, this.stop_.signal);
  }

  private async ask_(name: string, at: number | null, signal: AbortSignal): Promise<void> {
    this.isSurveying_ = true;
    try {
      this.survey.value = await surveyDeviation(this.session, name, at, signal);
    } catch (problem) {
      if (!signal.aborted) this.fail_(problem);
    }
    if (!signal.aborted) this.isSurveying_ = false;
  }

  private sayState_(): void {
    const { painted_: painted } = this;
    const part = this.chosen_.peek();
    if (!part || !painted) return;
    if (isOutside({ min: part.min_mm, max: part.max_mm }, this.bounds())) {
      const canMove = this.sent_?.file.name === part.name;
      this.say(t('The part lies outside the block: their origins differ'), canMove);
    } else if (painted.share < 1 || !this.survey.peek()) {
      this.say(t('Measuring… {0} %', 10 * Math.floor(10 * painted.share)));
    } else if (part.fault) {
      this.say(
        t('The part is not closed, so “too deep” and “left over” may be mixed up: {0}', part.fault),
      );
    } else {
      this.say('');
    }
  }

  setTolerance(mm: number): void {
    rememberPartTolerance(mm);
    this.mark_(null);
    this.toleranceMm.value = mm;
  }

  /** Colors the surface by the tolerance and the range of the survey. */
  private showScale_(): void {
    const { value: survey } = this.survey;
    const { value: toleranceMm } = this.toleranceMm;
    this.material_.setScale(toleranceMm, survey ? rangeOf(survey, toleranceMm) : 10 * toleranceMm);
    this.viewer.touch();
  }

  private mark_(place: DeviationPlace | null): void {
    this.place_.value = place;
    if (!place) this.note.say('');
  }

  /** Shows the deviation at the place that was pressed. */
  private showMark_(): void {
    const { value: place } = this.place_;
    const { value: units } = this.units;
    if (!place) {
      this.marker_.show([], []);
      return;
    }
    const { at_mm: at, normal, mm } = place;
    const end = plus(at, normal, ARM_PX * this.viewer.pixelMm(new Vector3(...at)));
    const text = `${signed(mm, units)} ${units}`;
    this.marker_.show([{ line: [at, end], place: end, text }], []);
  }

  /** Tells who cut a place, and looks at it from outside, a little from where the picture is seen now. */
  goTo(place: DeviationPlace): void {
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
