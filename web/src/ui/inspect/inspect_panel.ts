// SPDX-License-Identifier: Apache-2.0
// The panel for sections and measures, and their effect in the picture.

import { t } from '../../strings';
import '../style/inspect.css';
import '../style/deviation.css';
import { lengthText } from '../../model/measure';
import type { LengthUnit } from '../../model/measure';
import type { Bounds } from '../../model/session';
import { stockBounds } from '../../model/session';
import type { Layer, Viewer } from '../../view/viewer';
import type { Preset } from '../../view/camera_rig';
import { h } from '../dom';
import { recall, remember } from '../../strings/memory';
import { Authors } from '../authors';
import { Comparing } from './comparing';
import { CutNote } from './cut_note';
import { Measuring } from './measuring';
import { Ghost } from './ghost';
import type { InspectHost } from './host';
import { Owning } from './owning';
import { OwnerTip } from './owner_tip';
import { Picker } from './picker';
import { Probing } from './probing';
import { Sectioning } from './sectioning';
import { ViewCube } from './view_cube';

const UPDATE_MS = 100;
const TAP_PX = 5;
/** Where the panel takes the place of others (inspect.css). */
const NARROW = '(max-width: 1100px), (max-height: 560px)';

export class InspectPanel implements Layer {
  private readonly sectioning_: Sectioning;
  private readonly measuring_: Measuring;
  private readonly comparing_: Comparing | null = null;
  private readonly probing_: Probing | null = null;
  private readonly owning_: Owning | null = null;
  private readonly tip_: OwnerTip | null = null;
  private readonly close_ = (): void => this.setOpen_(false);
  private readonly cube_ = new ViewCube((preset) => this.view_(preset));
  private readonly element_: HTMLElement;
  private readonly parallel_ = this.toggleButton_(t('Parallel'), () => this.project_());
  private readonly curvature_ = this.toggleButton_(t('Curvature'), () =>
    this.setCurvature_(this.curvature_.getAttribute('aria-pressed') !== 'true'),
  );
  private readonly stock_ = this.toggleButton_(t('Stock'), () => this.ghost_?.toggle());
  private readonly ghost_: Ghost | null = null;
  private readonly legend_ = h('p', { class: 'curvature-legend', hidden: '' });
  private readonly inches_ = this.toggleButton_(t('Inches'), () => this.setInches_());
  private units_: LengthUnit = recall('units') === 'in' ? 'in' : 'mm';
  private timer_: ReturnType<typeof setInterval> | undefined;
  private pressedAt_: { x: number; y: number } | null = null;
  private hover_: PointerEvent | null = null;

  constructor(
    private readonly host: InspectHost,
    private readonly viewer: Viewer,
    private readonly opener: HTMLElement,
  ) {
    const { displayed } = viewer;
    const picker = new Picker(viewer, displayed);
    const bounds = (): Bounds => stockBounds(host.model.welcome!.stock);
    this.sectioning_ = new Sectioning(viewer, displayed, bounds);
    this.measuring_ = new Measuring(viewer, displayed, host, (x, y) =>
      picker.at(x, y, this.sectioning_.plane, this.sectioning_.outline, 2 * this.pitch_),
    );
    const { session } = host;
    const main = opener.closest('main') ?? document.body;
    if (session !== null) {
      const authors = new Authors(host.model, session);
      const note = (): CutNote => new CutNote(host, session, authors);
      this.comparing_ = new Comparing(viewer, host, session, bounds, note());
      this.probing_ = new Probing(note());
      const owning = new Owning(viewer, host, session, authors, bounds);
      this.owning_ = owning;
      const colorOf = (participant: number): string => owning.colorOf(participant);
      const { pick } = this.measuring_;
      // Not in the overlay, which is hidden from screen readers.
      this.tip_ = new OwnerTip({ ...host, parent: main, session, authors, colorOf, pick });
      const say = (reason: string): void => this.comparing_?.say(reason);
      this.ghost_ = new Ghost(viewer, session, this.stock_, say);
    }
    this.stock_.hidden = !this.ghost_;
    this.takeTurns_();
    const close = h('button', { type: 'button', class: 'inspect-action' }, t('Close'));
    close.addEventListener('click', () => this.toggle());
    this.element_ = h(
      'section',
      { class: 'inspect', 'aria-label': t('Sections and measurements'), hidden: '' },
      h('header', {}, h('h2', {}, t('Inspect')), close),
      this.sectioning_.element,
      this.measuring_.element,
      ...[this.probing_, this.owning_, this.comparing_].flatMap((part) => part?.element ?? []),
      h(
        'div',
        { class: 'inspect-foot' },
        this.cube_.element,
        h(
          'div',
          { class: 'inspect-toggles' },
          this.parallel_,
          this.curvature_,
          this.stock_,
          this.inches_,
        ),
      ),
      this.legend_,
    );
    main.append(this.element_, this.sectioning_.handle);
    new ResizeObserver(() => {
      main.style.setProperty('--inspect', `${this.element_.offsetHeight}px`);
      host.layoutChanged();
    }).observe(this.element_);
    this.listen_(main);
  }

  /** A press in the picture means one thing at a time, and so do the colors of the surface. */
  private takeTurns_(): void {
    const { sectioning_: sectioning, measuring_: measuring, probing_: probing } = this;
    if (this.owning_) this.owning_.chosen = () => this.comparing_?.close();
    if (this.comparing_) this.comparing_.chosen = () => this.owning_?.choose(false);
    sectioning.chosen = () => {
      measuring.choose(null);
      probing?.choose(false);
    };
    measuring.chosen = () => {
      sectioning.waitForFace(false);
      probing?.choose(false);
    };
    if (!probing) return;
    probing.chosen = () => {
      sectioning.waitForFace(false);
      measuring.choose(null);
    };
  }

  toggle(): void {
    const open = this.element_.hidden;
    this.setOpen_(open);
    if (!open) this.opener.focus();
  }

  private setOpen_(open: boolean): void {
    if (open) this.host.oneOpen.opens(this.close_);
    else this.host.oneOpen.closed(this.close_);
    if (open && matchMedia(NARROW).matches) this.closeTimeline_();
    this.element_.hidden = !open;
    this.opener.setAttribute('aria-expanded', String(open));
    this.element_.parentElement?.classList.toggle('has-inspect', open);
    this.host.picture.needExact(this, open);
    this.host.layoutChanged();
    clearInterval(this.timer_);
    if (open) {
      this.viewer.layers.add(this);
      this.timer_ = setInterval(() => this.update_(), UPDATE_MS);
      void this.comparing_?.open();
      this.setUnits_(this.units_);
      this.update_();
      this.viewer.touch();
    } else {
      this.viewer.layers.delete(this);
      this.sectioning_.choose('none');
      this.measuring_.clear();
      this.measuring_.choose(null);
      this.probing_?.choose(false);
      this.comparing_?.close();
      this.owning_?.choose(false);
      this.tip_?.leave();
      this.ghost_?.show(false);
      this.setCurvature_(false);
      this.viewer.displayed.forget();
    }
  }

  /** Part of each picture: the cube turns with it, the handle stays on the plane. */
  drawn(...[camera, width, height]: Parameters<NonNullable<Layer['drawn']>>): void {
    this.cube_.turn(camera);
    this.sectioning_.placeHandle(camera, width, height);
  }

  private get pitch_(): number {
    return this.host.model.welcome?.pitch_mm ?? 1;
  }

  private update_(): void {
    this.sectioning_.update(this.host.model.tiles.exact);
    this.comparing_?.update(performance.now());
    this.owning_?.update();
    this.updateTip_();
    this.parallel_.setAttribute('aria-pressed', String(this.viewer.rig.parallel));
    if (!this.hover_) return;
    this.measuring_.hover(this.hover_.offsetX, this.hover_.offsetY);
    this.hover_ = null;
  }

  private updateTip_(): void {
    const { owning_: owning, tip_: tip } = this;
    const { moves, parallel } = this.viewer.rig;
    if (this.tells_) tip?.update(`${owning?.revision}`, `${moves} ${parallel}`, performance.now());
    else tip?.leave();
  }

  /** Whether a note says who cut the surface under the pointer. */
  private get tells_(): boolean {
    return this.owning_?.isOn === true && !this.isPicking_;
  }

  /** It lies where the panel does. */
  private closeTimeline_(): void {
    const timeline = '[aria-label="Timeline"][aria-expanded="true"]';
    this.opener.closest('main')?.querySelector<HTMLElement>(timeline)?.click();
  }

  private listen_(main: Element): void {
    const { canvas } = this.host;
    const isOpen = (): boolean => !this.element_.hidden;
    canvas.addEventListener('pointerdown', (event) => {
      this.pressedAt_ = event.isPrimary ? { x: event.offsetX, y: event.offsetY } : null;
      this.tip_?.leave();
    });
    canvas.addEventListener('pointerup', (event) => {
      const { pressedAt_: at } = this;
      if (!isOpen() || !at || event.button !== 0) return;
      if (Math.hypot(event.offsetX - at.x, event.offsetY - at.y) < TAP_PX)
        this.press_(event.offsetX, event.offsetY);
    });
    canvas.addEventListener('pointermove', (event) => {
      if (!isOpen() || event.buttons !== 0) return;
      this.hover_ = event;
      if (this.tells_) this.tip_?.move(event.offsetX, event.offsetY, performance.now());
    });
    canvas.addEventListener('pointerleave', ({ pointerType }) => {
      if (pointerType === 'mouse') this.tip_?.leave(); // a finger leaves with each tap
    });
    canvas.addEventListener('keydown', ({ key }) => {
      if (isOpen() && key === 'Enter' && this.tells_) this.tip_?.press(...this.viewer.middle);
    });
    canvas.addEventListener(
      'dblclick',
      (event) => {
        if (this.isPicking_) event.stopImmediatePropagation();
      },
      { capture: true },
    );
    window.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape' || !isOpen()) return;
      this.tip_?.leave();
      if (!this.isPicking_) return;
      this.sectioning_.waitForFace(false);
      this.measuring_.choose(null);
      this.probing_?.choose(false);
    });
    main.querySelector('[aria-label="Timeline"]')?.addEventListener('click', () => {
      if (isOpen() && matchMedia(NARROW).matches) this.toggle();
    });
  }

  private get isPicking_(): boolean {
    const isOn = this.measuring_.isOn || this.sectioning_.waitsForFace || this.probing_?.isOn;
    return !this.element_.hidden && isOn === true;
  }

  private press_(x: number, y: number): void {
    if (this.tells_) this.tip_?.press(x, y);
    const picked = this.isPicking_ ? this.measuring_.pick(x, y) : null;
    if (!picked) return;
    if (this.sectioning_.waitsForFace) this.sectioning_.along(picked.point, picked.normal);
    else if (this.probing_?.isOn) void this.probing_.press(picked);
    else this.measuring_.press(picked);
  }

  private view_(preset: Preset): void {
    this.viewer.rig.preset(preset, performance.now());
  }

  private project_(): void {
    this.viewer.parallel = !this.viewer.rig.parallel;
    this.update_();
  }

  private setCurvature_(shown: boolean): void {
    this.curvature_.setAttribute('aria-pressed', String(shown));
    this.legend_.hidden = !shown;
    const { stockMaterial } = this.viewer;
    stockMaterial.curvature = shown;
    const radius = lengthText(stockMaterial.curvatureMm, this.units_);
    this.legend_.replaceChildren(
      h('span', { class: 'hollow' }, t('hollow')),
      h('span', { class: 'raised' }, t('raised')),
      t('full color up to a radius of {0}', radius),
    );
    this.viewer.touch();
  }

  private setInches_(): void {
    this.setUnits_(this.units_ === 'mm' ? 'in' : 'mm');
    remember('units', this.units_);
  }

  private setUnits_(units: LengthUnit): void {
    this.units_ = units;
    this.inches_.setAttribute('aria-pressed', String(units === 'in'));
    this.sectioning_.setUnits(units);
    this.measuring_.setUnits(units);
    this.probing_?.setUnits(units);
    this.comparing_?.setUnits(units);
    this.setCurvature_(!this.legend_.hidden);
    this.update_();
  }

  private toggleButton_(name: string, act: () => void): HTMLButtonElement {
    const button = h('button', { type: 'button', class: 'inspect-action' }, name);
    button.setAttribute('aria-pressed', 'false');
    button.addEventListener('click', act);
    return button;
  }
}
