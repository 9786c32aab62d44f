// SPDX-License-Identifier: Apache-2.0
// Carving in the page: takes pointer and keys, draws the tool, sends its path as an agent does, and
// cuts the page's copy of the block at once. A page without a server has the block itself.

import { signal } from '@preact/signals';
import type { VNode } from 'preact';
import { t } from '../strings';
import { MOUSE } from 'three';
import type { BlockCopy } from '../kernel/block_copy';
import { sentence } from '../ui/format';
import type { Viewer } from '../view/viewer';
import type { AgentHello } from '../wire/agent_control';
import { CarveBar, isTouched } from './carve_bar';
import type { AgentLink, CarveLinkEvents, CarveStatus } from './carve_link';
import { Coaching } from './coaching';
import { Delivery } from './delivery';
import { Devices } from './devices/devices';
import { openSpaceMouse } from './devices/open_space_mouse';
import { SpaceMouse } from './devices/space_mouse';
import { Gauge, GaugeView } from './gauge';
import { Hand } from './hand';
import { keepGestures } from './kept_gestures';
import { listenToCarveKeys } from './keys';
import { linkToServer } from './link_to_server';
import type { CarveHost } from './host';
import { Notes } from './notes';
import { Pointers } from './pointers';
import type { Place } from './place';
import { rejectionText, whyNotNow } from './reasons';
import { makeCopy, NO_COPY } from './local_copy';
import { Rumble } from './rumble';
import { diagonalOf, overBlock } from './devices/start';
import { Settling } from './settling';
import { Spring } from './spring';
import type { Stretch } from './spring';
import { toolMaker } from './make_tool';
import { StrokeChoices } from './stroke_choices';
import { ToolSettings } from './tool_settings';
import type { Wielded } from './tool/wielded';

const TICK_MS = 8;
const HELD_MS = 20; // of vibration
const LEFT_MS = 1000; // until the server's meshes of the last stroke are displayed
const TURN_RAD_PER_PX = 0.006;

export class CarveMode {
  private readonly notes_ = new Notes();
  private readonly coaching_ = new Coaching(isTouched);
  private readonly gauge_ = new Gauge();
  private readonly stretch_ = signal<Stretch | null>(null);
  private readonly hasSpaceMouse_ = signal(false);
  private readonly rumble_ = new Rumble();
  private readonly close_ = (): void => this.leave();
  private readonly copy_: BlockCopy | null; // null: the page has the block itself
  private readonly link_: AgentLink;
  private readonly hand_: Hand;
  private readonly delivery_: Delivery;
  private readonly settling_: Settling | null;
  private readonly spaceMouse_ = new SpaceMouse();
  private readonly devices_: Devices;
  private readonly settings_: ToolSettings;
  private readonly choices_: StrokeChoices;
  private pointers_: Pointers | null = null;
  private inHand_ = false; // the device is touched: it vibrates
  private stopKeys_: () => void = () => undefined;
  private timer_: ReturnType<typeof setInterval> | undefined;
  private mouseButtons_: object = {};

  constructor(
    private readonly host: CarveHost,
    private readonly viewer: Viewer,
  ) {
    this.hand_ = new Hand(viewer, (place) => (this.gauge_.place.value = place));
    this.settings_ = new ToolSettings(this.hand_, {
      isJoined: () => this.isJoined_(),
      color: () => this.who_().color,
      changes: () => this.stopStroke_(),
      ...toolMaker(host, () => this.copy_),
      say: (text) => this.notes_.say(sentence(text), true),
    });
    this.choices_ = new StrokeChoices(this.hand_, this.settings_, () => this.stopStroke_());
    this.copy_ = host.linkHere ? null : this.makeCopy_();
    this.link_ = this.makeLink_();
    this.settling_ = this.copy_ && new Settling(this.copy_, viewer.local);
    this.delivery_ = new Delivery(this.link_, this.hand_.sampler, () => this.hasEnded_());
    this.devices_ = new Devices(
      {
        wielded: this.wielded,
        sides: () => viewer.sides(),
        start: () => overBlock(host.model.welcome!),
        diagonalMm: () => diagonalOf(host.model.welcome!),
      },
      this.spaceMouse_,
    );
    if (!host.linkHere)
      keepGestures(host.session, this.hand_.sampler, (from, to) => this.link_.accepted(from, to));
    document.addEventListener('visibilitychange', () => {
      if (document.hidden) this.pointers_?.cancel();
    });
    window.addEventListener('online', () => this.link_.retryNow());
  }

  get isActive(): boolean {
    return this.pointers_ !== null;
  }

  enter(): void {
    const { welcome } = this.host.model;
    if (this.isActive || !welcome) return;
    this.host.oneOpen.opens(this.close_); // a section would hide the cut
    this.host.shell.isCarving.value = true;
    this.settings_.prepare(welcome);
    this.hand_.showsMirror = true;
    this.pointers_ = this.takePointers_();
    this.stopKeys_ = this.takeKeys_();
    const { mouseButtons } = this.viewer.rig.controls;
    this.mouseButtons_ = { ...mouseButtons };
    // The left button turns with Space.
    Object.assign(mouseButtons, { LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.PAN, RIGHT: MOUSE.ROTATE });
    this.viewer.hiddenCarver = this.link_.participant; // who may still be there
    void this.join_();
    this.openSpaceMouse_(false);
    this.timer_ = setInterval(() => this.tick_(), TICK_MS);
  }

  /** Whether something of the path is still drawn, sent or not answered. */
  get isBusy(): boolean {
    return this.hand_.isCutting || !this.delivery_.isSent || this.link_.isAsking;
  }

  /** The hash of the page's copy of the block; null: it has none. */
  copyHash(): Promise<string | null> | null {
    return this.copy_?.works ? this.copy_.hash() : null;
  }

  /** The tool, for devices that are no pointers. */
  get wielded(): Wielded {
    return {
      whyNot: () => whyNotNow(this.host.model, this.isJoined_()),
      settings: this.settings_,
      moveTo: (pose, cuts) => this.hand_.moveTo(pose, cuts, this.isJoined_()),
      lift: () => this.hand_.lift(),
      pose: () => this.hand_.pose,
      undo: () => this.undo_(),
      redo: () => this.redo_(),
      forceN: () => this.gauge_.forceN,
      say: (text) => this.notes_.say(text, true),
    };
  }

  leave(): void {
    if (!this.pointers_) return;
    this.host.oneOpen.closed(this.close_);
    this.pointers_.dispose();
    this.pointers_ = null;
    clearInterval(this.timer_);
    this.delivery_.leave();
    this.hand_.rest();
    this.stopKeys_();
    this.viewer.hiddenCarver = null;
    Object.assign(this.viewer.rig.controls.mouseButtons, this.mouseButtons_);
    this.host.shell.isCarving.value = false;
  }

  private openSpaceMouse_(asks: boolean): void {
    const say = (text: string): void => this.notes_.say(text, true);
    void openSpaceMouse(this.spaceMouse_, asks, this.hasSpaceMouse_, say);
  }

  /** Joins with the copy, if there can be one. */
  private async join_(): Promise<void> {
    this.notes_.show(t('Joining…'));
    const hasCopy = (await this.copy_?.isThere) ?? true;
    if (!this.isActive) return;
    this.delivery_.join();
    if (!hasCopy) this.notes_.say(NO_COPY);
  }

  bar(): VNode | null {
    if (!this.host.shell.isCarving.value) return null;
    const { spaceMouse_: mouse } = this;
    return (
      <CarveBar
        shell={this.host.shell}
        settings={this.settings_}
        choices={this.choices_}
        notes={this.notes_}
        spaceMouse={
          mouse.canBe
            ? { isThere: this.hasSpaceMouse_, choose: () => this.openSpaceMouse_(true) }
            : null
        }
        undo={() => this.undo_()}
        redo={() => this.redo_()}
        done={() => this.leave()}
      />
    );
  }

  /** The force and the drag of the tool, over the picture. */
  marks(): VNode | null {
    if (!this.host.shell.isCarving.value) return null;
    return (
      <>
        <Spring ends={this.stretch_} />
        <GaugeView gauge={this.gauge_} />
      </>
    );
  }

  private makeCopy_(): BlockCopy {
    return makeCopy(
      this.viewer,
      (forceN) => this.feel_(forceN),
      () => this.link_.ask({ type: 'stock' }),
      (reason) => console.warn('The copy of the block has ended:', reason),
    );
  }

  private makeLink_(): AgentLink {
    const { host, copy_: copy } = this;
    const events: CarveLinkEvents = {
      status: (status, reason) => this.linkChanged_(status, reason),
      joined: (welcome) => this.joined_(welcome),
      result: (result) => this.felt_(result),
      rejected: (code, reason) => this.rejected_(code, reason),
      changed: (undone) => this.changed_(undone),
    };
    if (!copy) return host.linkHere!(events);
    const who = (): Pick<AgentHello, 'name' | 'color' | 'tool'> => ({
      ...this.who_(),
      tool: this.settings_.tool?.id ?? 0,
    });
    return linkToServer(host.session, copy, who, events);
  }

  private takePointers_(): Pointers {
    const { rig } = this.viewer;
    const height = (): number => Math.max(1, this.host.canvas.clientHeight);
    return new Pointers(this.host.canvas, {
      hover: (place) => this.hand_.hover(place, this.isJoined_()),
      begin: (place, onPlane) => this.begin_(place, onPlane),
      holdPlane: () => this.holdPlane_(),
      move: (places) => this.hand_.move(places, this.settings_.depthMm),
      end: () => this.end_(),
      deepen: (factor) => this.settings_.setDepth(this.settings_.depthMm * factor),
      turn: (dx, dy, closer) => {
        rig.orbit(-dx * TURN_RAD_PER_PX, dy * TURN_RAD_PER_PX);
        rig.zoom(closer);
      },
      pan: (dx, dy) => rig.pan(-dx / height(), dy / height()),
      undo: () => this.undo_(),
      redo: () => this.redo_(),
    });
  }

  private takeKeys_(): () => void {
    return listenToCarveKeys({
      escape: () => {
        if (!this.pointers_?.cancel()) this.leave();
      },
      undo: () => this.undo_(),
      redo: () => this.redo_(),
      nextTool: (step) => this.settings_.nextTool(step),
      resize: (direction) => this.settings_.resize(direction),
      ...this.choices_.keys,
      space: (held) => {
        if (this.pointers_) this.pointers_.spaceHeld = held;
      },
    });
  }

  // Strokes

  private begin_(place: Place, onPlane: boolean): void {
    const reason = whyNotNow(this.host.model, this.isJoined_());
    if (reason !== '') {
      this.notes_.say(reason, true);
      return;
    }
    this.inHand_ = place.pressure !== null || isTouched();
    if (onPlane) this.hand_.holdPlane();
    const problem = this.hand_.begin(place, this.settings_.depthMm);
    if (problem !== '') this.notes_.say(problem, true);
  }

  private holdPlane_(): void {
    this.hand_.holdPlane();
    if ('vibrate' in navigator) navigator.vibrate(HELD_MS);
    this.notes_.say(t('This stroke stays on one plane.'));
  }

  private end_(): void {
    if (this.hand_.isCutting) this.coaching_.stroked();
    this.hand_.end(this.settings_.depthMm);
    this.delivery_.step();
    if (isTouched()) this.hand_.hide(); // no pointer is left over the picture
  }

  /** Ends the stroke of whatever device, if there is one. */
  private stopStroke_(): void {
    this.pointers_?.cancel();
    this.hand_.lift();
  }

  private undo_(): void {
    this.stopStroke_();
    if (this.hand_.sampler.undo()) this.changed_(true);
  }

  private redo_(): void {
    this.stopStroke_();
    if (this.hand_.sampler.redo()) this.changed_(false);
  }

  private changed_(undone: boolean): void {
    this.notes_.say(undone ? t('Your stroke was undone.') : t('Your stroke was redone.'));
  }

  private hasEnded_(): boolean {
    return this.host.model.status === 'stopped';
  }

  private isJoined_(): boolean {
    return this.link_.status === 'ready';
  }

  private tick_(): void {
    const { welcome, state } = this.host.model;
    const now = performance.now();
    if (this.hasEnded_()) {
      this.leave(); // the link would try for ever
      return;
    }
    if (welcome) this.settings_.prepare(welcome);
    if (this.hand_.isCutting && state?.at) this.stopStroke_();
    this.settling_?.step(state, this.link_.isAsking, now);
    this.hand_.settle(this.settings_.depthMm, now);
    this.hand_.pull(this.gauge_.share, now);
    this.stretch_.value = this.hand_.isCutting ? this.hand_.stretch : null;
    if (!this.viewer.eyeElsewhere) this.devices_.tick(now);
    this.gauge_.update(this.viewer.arrowScale.forceFullN, now);
    if (this.hand_.isOnSide) this.coaching_.leaned();
    if (this.isJoined_()) this.notes_.showLater(this.coaching_.text, now);
  }

  /** Name and color of the watcher: others see one person. */
  private who_(): { name: string; color: string } {
    return { name: this.host.name(), color: this.host.model.welcome!.color };
  }

  // The server

  private linkChanged_(status: CarveStatus, reason: string): void {
    this.host.shell.carveStatus.value = status;
    if (status === 'lost') {
      this.stopStroke_();
      this.notes_.say(t('{0} Reconnecting…', sentence(reason)), true);
    } else if (status === 'joining' && reason === '') {
      this.notes_.show(t('Joining…'));
    } else if (status === 'ready') {
      this.notes_.forget();
    } else if (status === 'off') {
      setTimeout(() => {
        if (this.copy_ && this.link_.status === 'off') this.viewer.local.close();
      }, LEFT_MS);
      if (reason === '') return;
      this.host.say(sentence(reason));
      this.leave();
    }
  }

  private joined_({
    participant,
    speedMmPerS,
    samplesPerS,
  }: Parameters<CarveLinkEvents['joined']>[0]): void {
    this.hand_.sampler.limits = { speedMmPerS, samplesPerS };
    this.viewer.hiddenCarver = participant;
    this.viewer.local.open();
  }

  private felt_(result: Parameters<CarveLinkEvents['result']>[0]): void {
    const { force_n, agent_sequence, motions_applied } = result;
    if (this.copy_) this.viewer.local.answered(agent_sequence, Number(motions_applied));
    // The copy has reported it before, unless it does not work.
    if (!this.copy_?.works) this.feel_(Math.hypot(...force_n));
  }

  private feel_(forceN: number): void {
    const now = performance.now();
    this.gauge_.feel(forceN, now);
    this.rumble_.feel(forceN / this.viewer.arrowScale.forceFullN, this.inHand_, now);
  }

  private rejected_(code: string, reason: string): void {
    if (code === 'in_stock') this.stopStroke_(); // lifted, the tool is clear of it
    this.notes_.say(sentence(rejectionText(reason)), true);
  }
}
