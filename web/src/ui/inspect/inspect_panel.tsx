// SPDX-License-Identifier: Apache-2.0
// The panel for sections and measures, and their effect in the picture.

import { effect, signal, untracked } from '@preact/signals';
import './inspect.css';
import './marks.css';
import './owners.css';
import '../style/deviation.css';
import type { LengthUnit } from '../../model/measure';
import type { Bounds } from '../../model/session';
import { stockBounds } from '../../model/session';
import type { Layer, Viewer } from '../../view/viewer';
import type { Preset } from '../../view/camera_rig';
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
  readonly sectioning: Sectioning;
  readonly measuring: Measuring;
  readonly comparing: Comparing | null = null;
  readonly probing: Probing | null = null;
  readonly owning: Owning | null = null;
  readonly tip: OwnerTip | null = null;
  readonly ghost: Ghost | null = null;
  readonly cube = new ViewCube();
  readonly units = signal<LengthUnit>(recall('units') === 'in' ? 'in' : 'mm');
  readonly isParallel = signal(false);
  readonly hasCurvature = signal(false);
  private readonly close_ = (): void => void (this.host.shell.isInspectOpen.value = false);
  private timer_: ReturnType<typeof setInterval> | undefined;
  private pressedAt_: { x: number; y: number } | null = null;
  private hover_: PointerEvent | null = null;

  constructor(
    readonly host: InspectHost,
    private readonly viewer: Viewer,
  ) {
    const { displayed } = viewer;
    const { units } = this;
    const picker = new Picker(viewer, displayed);
    const bounds = (): Bounds => stockBounds(host.model.welcome!.stock);
    this.sectioning = new Sectioning(viewer, displayed, bounds);
    this.measuring = new Measuring(viewer, displayed, host, units, (x, y) =>
      picker.at(x, y, this.sectioning.plane, this.sectioning.outline, 2 * this.pitch_),
    );
    const { session } = host;
    if (session !== null) {
      const authors = new Authors(host.model, session);
      const note = (): CutNote => new CutNote(host, session, authors);
      this.comparing = new Comparing(viewer, host, session, bounds, units, note());
      this.probing = new Probing(note());
      const owning = new Owning(viewer, host, session, authors, bounds);
      this.owning = owning;
      const colorOf = (participant: number): string => owning.colorOf(participant);
      const { pick } = this.measuring;
      this.tip = new OwnerTip({ ...host, session, authors, colorOf, pick });
      const say = (reason: string): void => this.comparing?.say(reason);
      this.ghost = new Ghost(viewer, session, say);
    }
    this.takeTurns_();
    this.listen_();
    let isOpen = false;
    effect(() => {
      const { value } = host.shell.isInspectOpen;
      if (value === isOpen) return;
      isOpen = value;
      untracked(() => (value ? this.opened_() : this.closed_()));
    });
    // The timeline occupies the same area.
    effect(() => {
      if (host.shell.isTimelineOpen.value && matchMedia(NARROW).matches) this.close_();
    });
  }

  /** A press in the picture means one thing at a time, and so do the colors of the surface. */
  private takeTurns_(): void {
    const { sectioning, measuring, probing } = this;
    if (this.owning) this.owning.chosen = () => this.comparing?.close();
    if (this.comparing) this.comparing.hasChosen = () => this.owning?.choose(false);
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
    const { isInspectOpen: isOpen } = this.host.shell;
    isOpen.value = !isOpen.peek();
    if (!isOpen.peek()) this.host.shell.focus('inspect');
  }

  private opened_(): void {
    this.host.oneOpen.opens(this.close_);
    if (matchMedia(NARROW).matches) this.host.shell.isTimelineOpen.value = false;
    this.host.picture.needExact(this, true);
    this.viewer.layers.add(this);
    clearInterval(this.timer_);
    this.timer_ = setInterval(() => this.update_(), UPDATE_MS);
    void this.comparing?.open();
    this.update_();
    this.viewer.touch();
  }

  private closed_(): void {
    this.host.oneOpen.closed(this.close_);
    this.host.picture.needExact(this, false);
    clearInterval(this.timer_);
    this.viewer.layers.delete(this);
    this.sectioning.choose('none');
    this.measuring.clear();
    this.measuring.choose(null);
    this.probing?.choose(false);
    this.comparing?.close();
    this.owning?.choose(false);
    this.tip?.leave();
    this.ghost?.show(false);
    this.showCurvature(false);
    this.viewer.displayed.forget();
  }

  /** Part of each picture: the cube turns with it, the handle stays on the plane. */
  drawn(...[camera, width, height]: Parameters<NonNullable<Layer['drawn']>>): void {
    this.cube.turn(camera);
    this.sectioning.placeHandle(camera, width, height);
  }

  private get pitch_(): number {
    return this.host.model.welcome?.pitch_mm ?? 1;
  }

  private update_(): void {
    this.sectioning.update(this.host.model.tiles.exact);
    this.comparing?.update(performance.now());
    this.owning?.update();
    this.updateTip_();
    this.isParallel.value = this.viewer.rig.parallel;
    if (!this.hover_) return;
    this.measuring.hover(this.hover_.offsetX, this.hover_.offsetY);
    this.hover_ = null;
  }

  private updateTip_(): void {
    const { owning, tip } = this;
    const { moves, parallel } = this.viewer.rig;
    if (this.tells_) tip?.update(`${owning?.revision}`, `${moves} ${parallel}`, performance.now());
    else tip?.leave();
  }

  /** Whether a note says who cut the surface under the pointer. */
  private get tells_(): boolean {
    return this.owning?.isOn === true && !this.isPicking_;
  }

  private listen_(): void {
    const { canvas } = this.host;
    const isOpen = (): boolean => this.host.shell.isInspectOpen.peek();
    canvas.addEventListener('pointerdown', (event) => {
      this.pressedAt_ = event.isPrimary ? { x: event.offsetX, y: event.offsetY } : null;
      this.tip?.leave();
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
      if (this.tells_) this.tip?.move(event.offsetX, event.offsetY, performance.now());
    });
    canvas.addEventListener('pointerleave', ({ pointerType }) => {
      if (pointerType === 'mouse') this.tip?.leave(); // a finger leaves with each tap
    });
    canvas.addEventListener('keydown', ({ key }) => {
      if (isOpen() && key === 'Enter' && this.tells_) this.tip?.press(...this.viewer.middle);
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
      this.tip?.leave();
      if (!this.isPicking_) return;
      this.sectioning.waitForFace(false);
      this.measuring.choose(null);
      this.probing?.choose(false);
    });
  }

  private get isPicking_(): boolean {
    const { measuring, sectioning, probing, host } = this;
    const isOn = measuring.isOn || sectioning.waitsForFace || probing?.isOn.value;
    return host.shell.isInspectOpen.peek() && isOn === true;
  }

  private press_(x: number, y: number): void {
    if (this.tells_) this.tip?.press(x, y);
    const picked = this.isPicking_ ? this.measuring.pick(x, y) : null;
    if (!picked) return;
    if (this.sectioning.waitsForFace) this.sectioning.along(picked.point, picked.normal);
    else if (this.probing?.isOn.peek()) void this.probing.press(picked);
    else this.measuring.press(picked);
  }

  show(preset: Preset): void {
    this.viewer.rig.preset(preset, performance.now());
  }

  toggleParallel(): void {
    this.viewer.parallel = !this.viewer.rig.parallel;
    this.update_();
  }

  showCurvature(isShown: boolean): void {
    this.hasCurvature.value = isShown;
    this.viewer.stockMaterial.curvature = isShown;
    this.viewer.touch();
  }

  /** The radius with the full color of the curvature, mm. */
  get curvatureMm(): number {
    return this.viewer.stockMaterial.curvatureMm;
  }

  toggleUnits(): void {
    this.units.value = this.units.peek() === 'mm' ? 'in' : 'mm';
    remember('units', this.units.peek());
  }
}
