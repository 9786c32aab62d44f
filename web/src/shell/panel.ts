// SPDX-License-Identifier: Apache-2.0
// The side panel (a bottom sheet on phones): figures, participants, plots, downloads, material.

import { signal } from '@preact/signals';
import { t } from '../strings';
import { pageAddress } from '../link/request';
import type { StockMaterialPreset } from '../model/materials';
import type { Participant } from '../model/participants';
import type { SessionModel } from '../model/session';
import { connectionText } from '../ui/badge';
import { h, setText } from '../ui/dom';
import { capMouse } from '../carve/devices/cap_mouse';
import type { CapMouseHost } from '../carve/devices/cap_mouse';
import { languageChoice } from '../ui/language_choice';
import { details, Figure, section } from '../ui/figures';
import { count, duration, figure, volume } from '../ui/format';
import type { Navigation } from '../model/navigation';
import { History } from '../ui/history';
import { MaterialChoice } from '../ui/material_choice';
import { mountCheck } from '../replay/mount';
import type { Viewer } from '../view/viewer';
import { navigationChoice } from '../ui/navigation_choice';
import { peopleLists } from '../ui/people';
import type { PersonChoice } from '../ui/person_choice';
import { PlotSpot } from '../ui/plot_spot';
import { takeHomeButton } from '../ui/take_home/mount';

const SILENT_MS = 1500; // without a tool state for so long, there is no newest force
export interface PanelActions {
  /** The viewer has chosen another name. */
  renamed: (name: string) => void;
  /** The picture's; null: it is not there yet, or there is none. */
  viewer: () => Viewer | null;
  materialChosen: (look: StockMaterialPreset) => void;
  navigationChosen: (navigation: Navigation) => void;
  /** The camera that a 3D mouse moves. */
  capMouse: CapMouseHost;
  /** The panel was resized. */
  layoutChanged: () => void;
  /** The bottom sheet (on phones) was opened or closed. */
  toggled: (open: boolean) => void;
}

export class Panel {
  readonly element: HTMLElement;
  private readonly handle_ = h(
    'button',
    { type: 'button', class: 'sheet-handle', 'aria-expanded': 'false' },
    t('Show more'),
  );
  private readonly motions_ = new Figure(t('Motions'));
  private readonly removed_ = new Figure(t('Removed'));
  private readonly triangles_ = new Figure(t('Triangles'));
  private readonly pitch_ = new Figure(t('Grid spacing'));
  private readonly hash_ = h('code', {
    title: t('State hash: the same hash means the same block'),
    'data-settled': t('complete'),
  });
  private readonly connection_ = h('p', { class: 'quiet hash', title: t('Connection') });
  private readonly plotOf_ = h('span', { class: 'plot-of' });
  private plotted_: Participant | null = null; // stays when the participant leaves
  private readonly material_: MaterialChoice;
  private readonly nowMs_ = signal(0);
  readonly history: History;
  private readonly plots_: PlotSpot;

  constructor(
    private readonly model: SessionModel,
    session: string,
    colors: { force: string; torque: string },
    private readonly choice: PersonChoice,
    together: HTMLElement,
    private readonly actions: PanelActions,
  ) {
    this.material_ = new MaterialChoice(actions.materialChosen);
    this.history = new History(model, session);
    this.plots_ = new PlotSpot(colors);
    const { nowMs_: nowMs } = this;
    const people = peopleLists({ model, choice, nowMs, renamed: actions.renamed });
    const check = mountCheck(session, model, actions.viewer);
    const figures = [this.motions_, this.triangles_, this.pitch_].map(({ element }) => element);
    const forces = section(t('Forces'), this.plots_.element);
    forces.querySelector('h2')?.append(this.plotOf_);
    this.element = h(
      'aside',
      { class: 'panel', 'aria-label': t('Session') },
      this.handle_,
      h(
        'div',
        { class: 'panel-scroll' },
        h('dl', { class: 'figures' }, this.removed_.element),
        section(t('Participants'), people),
        together,
        forces,
        section(t('History'), this.history.element),
        section(t('Downloads'), takeHomeButton(model, session)),
        section(t('Material'), this.material_.element),
        check ? h('p', { class: 'quiet hash' }, check) : '',
        details(
          h('dl', { class: 'figures' }, ...figures),
          h('p', { class: 'quiet hash' }, t('State hash '), this.hash_),
          this.connection_,
        ),
        h(
          'div',
          { class: 'preferences' },
          languageChoice(() => location.assign(pageAddress())),
          navigationChoice(actions.navigationChosen),
          capMouse(actions.capMouse) ?? '',
        ),
      ),
    );
    this.handle_.addEventListener('click', () => this.toggle_());
    new ResizeObserver(() => actions.layoutChanged()).observe(this.element);
  }

  /**
   * Updates the panel from the model; called about ten times a second.
   * @param started the first picture is drawn, or there is none, so that code that it does not need
   * may be loaded
   */
  update(nowMs: number, started: boolean): void {
    const { state, welcome, tiles } = this.model;
    const { selected } = this.choice;
    this.nowMs_.value = nowMs;
    this.motions_.set(state ? count(state.motions) : '–');
    this.removed_.set(
      ...(state ? volume(state.removed_volume_mm3) : (['–', ''] as [string, string])),
    );
    this.triangles_.set(count(tiles.triangles));
    this.pitch_.set(welcome ? figure(welcome.pitch_mm) : '–', 'mm');
    setText(this.hash_, state?.state_hash ?? '–');
    const isThere = tiles.complete && !this.model.lag.isBehind(nowMs);
    const isComplete = state?.settled === true && isThere;
    this.hash_.classList.toggle('settled', isComplete);
    setText(this.connection_, connectionText(this.model, nowMs));
    this.material_.suggest(this.model.participants.carvers().map(({ info }) => info.kind));
    this.history.update(selected, nowMs);
    const { participants } = this.model;
    this.plotted_ = (selected === null ? undefined : participants.get(selected)) ?? this.plotted_;
    if (this.plotted_ && started) this.plot_(this.plotted_, nowMs);
  }

  /** Plots the forces of a participant, also after it has left. */
  private plot_({ info, seenMs, forces, feltShare }: Participant, nowMs: number): void {
    const silentMs = nowMs - seenMs;
    const silent = silentMs > SILENT_MS;
    const isGone = !this.model.participants.get(info.participant);
    const ago = isGone && Number.isFinite(silentMs) ? t(', {0} ago', duration(silentMs)) : '';
    setText(this.plotOf_, info.name + ago);
    this.plots_.show(forces, nowMs / 1000, silent ? 'gone' : feltShare);
  }

  private toggle_(): void {
    const open = this.element.classList.toggle('open');
    this.handle_.setAttribute('aria-expanded', String(open));
    this.handle_.textContent = open ? t('Show less') : t('Show more');
    this.actions.toggled(open);
  }
}
