// SPDX-License-Identifier: Apache-2.0
// Colors the surface by who cut it, with a legend that states each participant's share of the cut.
// Pressing a participant grays out the rest.

import { signal } from '@preact/signals';
import { t } from '../../strings';
import { OWNER_NUMBERS, OWNER_POINTS_MAX, ownersAt } from '../../link/owners';
import type { Bounds } from '../../model/session';
import { addAreas, apart, middlesOf, distinctFrom } from '../../model/owners';
import { paintedEdge } from '../../model/refine';
import { OwnerMaterial, SLOTS } from '../../view/inspect/owner_material';
import { PaintedView, trianglesOf } from '../../view/inspect/painted_view';
import type { Painting } from '../../view/inspect/painted_view';
import type { Viewer } from '../../view/viewer';
import type { Authors } from '../authors';
import { sentence } from '../format';
import type { InspectHost } from './host';

/** An entry of the legend. */
interface Entry {
  slot: number;
  name: string;
  color: string;
  /** Share of the cut surface. */
  percent: number;
}

export class Owning {
  /** The colors are shown, in place of others. */
  chosen: () => void = () => undefined;
  private readonly isOn_ = signal(false);
  readonly hint = signal('');
  readonly legend = signal<readonly Entry[]>([]);
  /** The slot that is shown in color alone; null: all are. */
  readonly alone = signal<number | null>(null);
  private painted_: PaintedView | null = null;
  private material_ = new OwnerMaterial();
  private stop_ = new AbortController();
  /** Participants by slot; their places do not change while the colors are shown. */
  private owners_: number[] = [];
  private colors_: string[] = [];
  private drawn_ = '';

  constructor(
    private readonly viewer: Viewer,
    private readonly host: InspectHost,
    private readonly session: string,
    private readonly authors: Authors,
    private readonly bounds: () => Bounds,
  ) {}

  get isOn(): boolean {
    return this.isOn_.value;
  }

  /** Differs when the colored surface does. */
  get revision(): number {
    return this.painted_?.revision ?? 0;
  }

  /** As in the legend. */
  colorOf(participant: number): string {
    const slot = this.owners_.indexOf(participant);
    return this.colors_[slot] ?? this.authors.colorOf(participant);
  }

  choose(on: boolean): void {
    if (on === this.isOn) return;
    if (on) this.chosen();
    this.isOn_.value = on;
    this.stop_.abort();
    this.stop_ = new AbortController();
    this.painted_?.dispose();
    this.painted_ = null;
    this.owners_ = [];
    this.colors_ = [];
    this.drawn_ = '';
    this.setAlone(null);
    this.legend.value = [];
    this.say_('');
    if (!on) return;
    this.material_ = new OwnerMaterial();
    this.painted_ = new PaintedView(this.viewer, this.painting_(), (problem) =>
      this.fail_(problem),
    );
    void this.authors.load().then(() => this.colorAll_());
  }

  /** Called some times a second while the panel is open. */
  update(): void {
    const { painted_: painted } = this;
    if (!painted) return;
    painted.update();
    const { share } = painted;
    const done = share < 1 ? 10 * Math.floor(10 * share) : 100;
    const drawn = `${painted.revision} ${done} ${this.alone.peek()} ${this.colors_.join('')}`;
    if (drawn === this.drawn_) return;
    this.drawn_ = drawn;
    this.legend.value = this.entriesOf_(painted);
    if (done < 100) this.say_(t('Finding who cut what… {0} %', done));
    else this.say_(this.legend.peek().length === 0 ? t('Nobody has cut anything yet') : '');
  }

  private painting_(): Painting {
    const limitMm = paintedEdge(this.host.model.welcome?.pitch_mm ?? 0, this.bounds());
    const { signal } = this.stop_;
    return {
      material: this.material_.material,
      trianglesOf: (tile) => {
        const isOriginal = this.viewer.tiles.originalOf(tile); // nobody needs to be asked of it
        const isCut = (...corners: number[]): boolean => !corners.every(isOriginal);
        return trianglesOf(tile, limitMm, isCut);
      },
      questionsOf: middlesOf,
      numbers: OWNER_NUMBERS,
      questionsMax: OWNER_POINTS_MAX,
      ask: (points) =>
        ownersAt(this.session, points, this.host.model.state?.at?.record ?? null, signal),
      paint: (triangles, owners) =>
        apart(
          triangles,
          (n) => owners[n] !== 0,
          (n) => this.slotOf_(owners[n]!),
        ),
      rests: true,
    };
  }

  private slotOf_(owner: number): number {
    const known = this.owners_.indexOf(owner);
    if (known >= 0) return Math.min(known, SLOTS - 1);
    this.owners_.push(owner);
    if (this.authors.knows(owner)) this.colorAll_();
    else void this.authors.load().then(() => this.colorAll_());
    return Math.min(this.owners_.length, SLOTS) - 1;
  }

  /** The first to be found keep their own colors. */
  private colorAll_(): void {
    this.colors_ = [];
    for (const owner of this.owners_.slice(0, SLOTS - 1))
      this.colors_.push(distinctFrom(this.authors.colorOf(owner), this.colors_));
    this.colors_.forEach((color, slot) => this.material_.setColor(slot, color));
    this.viewer.touch();
  }

  private entriesOf_(painted: PaintedView): Entry[] {
    const areas = new Map<number, number>();
    for (const piece of painted.pieces()) addAreas(piece, areas);
    const all = [...areas.values()].reduce((sum, area) => sum + area, 0);
    return [...areas]
      .sort(([, a], [, b]) => b - a)
      .map(([slot, area]) => ({
        slot,
        percent: (100 * area) / all,
        name: slot === SLOTS - 1 ? t('Others') : this.authors.nameOf(this.owners_[slot]!),
        color: this.colors_[slot] ?? '#808080',
      }));
  }

  setAlone(slot: number | null): void {
    this.alone.value = slot;
    this.material_.setAlone(slot);
    this.viewer.touch();
  }

  private say_(text: string): void {
    this.hint.value = text === '' ? '' : sentence(text);
  }

  private fail_(problem: unknown): void {
    this.choose(false);
    this.say_((problem as Error).message);
  }
}
