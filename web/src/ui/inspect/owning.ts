// SPDX-License-Identifier: Apache-2.0
// Colors the surface by who cut it, with a legend that states each participant's share of the cut.
// Pressing a participant grays out the rest.

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
import { h, setText } from '../dom';
import { figure, sentence } from '../format';
import type { InspectHost } from './host';

export class Owning {
  /** The colors are shown, in place of others. */
  chosen: () => void = () => undefined;
  private readonly button_ = h(
    'button',
    { type: 'button', class: 'inspect-action', 'aria-pressed': 'false' },
    t('Color by participant'),
  );
  private readonly hint_ = h('p', { class: 'quiet inspect-hint', role: 'status', hidden: '' });
  private readonly how_ = h(
    'p',
    { class: 'quiet inspect-hint', hidden: '' },
    t('Point at or click a spot to see who cut it. Press Enter for the middle of the view.'),
  );
  private readonly legend_ = h('ul', { class: 'owner-legend', 'aria-label': t('Who cut what') });
  readonly element: HTMLElement;
  private painted_: PaintedView | null = null;
  private material_ = new OwnerMaterial();
  private stop_ = new AbortController();
  /** Participants by slot; their places do not change while the colors are shown. */
  private owners_: number[] = [];
  private colors_: string[] = [];
  private alone_: number | null = null;
  private drawn_ = '';

  constructor(
    private readonly viewer: Viewer,
    private readonly host: InspectHost,
    private readonly session: string,
    private readonly authors: Authors,
    private readonly bounds: () => Bounds,
  ) {
    this.button_.addEventListener('click', () => this.choose(!this.isOn));
    this.element = h(
      'section',
      { 'aria-label': t('Who cut what'), class: 'owners' },
      h('div', { class: 'inspect-row' }, this.button_),
      this.hint_,
      this.legend_,
      this.how_,
    );
  }

  get isOn(): boolean {
    return this.button_.getAttribute('aria-pressed') === 'true';
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
    this.how_.hidden = !on;
    if (on) this.chosen();
    this.button_.setAttribute('aria-pressed', String(on));
    this.stop_.abort();
    this.stop_ = new AbortController();
    this.painted_?.dispose();
    this.painted_ = null;
    this.owners_ = [];
    this.colors_ = [];
    this.drawn_ = '';
    this.setAlone_(null);
    this.legend_.replaceChildren();
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
    const drawn = `${painted.revision} ${done} ${this.alone_} ${this.colors_.join('')}`;
    if (drawn === this.drawn_) return;
    this.drawn_ = drawn;
    this.drawLegend_(painted);
    if (done < 100) this.say_(t('Finding who cut what… {0} %', done));
    else this.say_(this.legend_.childElementCount === 0 ? t('Nobody has cut anything yet') : '');
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

  private drawLegend_(painted: PaintedView): void {
    const areas = new Map<number, number>();
    for (const piece of painted.pieces()) addAreas(piece, areas);
    const all = [...areas.values()].reduce((sum, area) => sum + area, 0);
    const focused = this.legend_.contains(document.activeElement)
      ? (document.activeElement as HTMLElement).dataset['slot']
      : undefined;
    const entries = [...areas].sort(([, a], [, b]) => b - a);
    this.legend_.replaceChildren(
      ...entries.map(([slot, area]) => this.entry_(slot, (100 * area) / all)),
    );
    this.legend_.querySelector<HTMLElement>(`[data-slot="${focused ?? ''}"]`)?.focus();
  }

  private entry_(slot: number, percent: number): HTMLElement {
    const isRest = slot === SLOTS - 1;
    const name = isRest ? t('Others') : this.authors.nameOf(this.owners_[slot]!);
    const button = h(
      'button',
      {
        type: 'button',
        'aria-pressed': String(this.alone_ === slot),
        'data-slot': String(slot),
        title: t('Show what {0} cut', name),
      },
      h('span', {
        class: 'owner-color',
        style: `background:${this.colors_[slot] ?? '#808080'}`,
        'aria-hidden': 'true',
      }),
      h('span', { class: 'owner-name' }, name),
      h('span', { class: 'owner-share' }, `${figure(percent)} %`),
    );
    button.addEventListener('click', () => this.setAlone_(this.alone_ === slot ? null : slot));
    return h('li', {}, button);
  }

  private setAlone_(slot: number | null): void {
    this.alone_ = slot;
    this.material_.setAlone(slot);
    this.viewer.touch();
    this.update();
  }

  private say_(text: string): void {
    this.hint_.hidden = text === '';
    setText(this.hint_, text === '' ? '' : sentence(text));
  }

  private fail_(problem: unknown): void {
    this.choose(false);
    this.say_((problem as Error).message);
  }
}
