// SPDX-License-Identifier: Apache-2.0
// The page of one session: connects link, model, view and panels.

import { t } from '../strings';
import { mountCarve } from '../carve/mount';
import type { CarveSwitch } from '../carve/mount';
import { socketUrl } from '../link/address';
import { probeSession } from '../link/api';
import { openView } from '../link/early_socket';
import { reloadAt } from '../link/redirect';
import { notLoaded, pageAddress, useServer } from '../link/request';
import { ViewLink } from '../link/view_link';
import { wrenchColors } from '../model/arrow_scale';
import { BEAT_MS } from '../model/liveness';
import { LookPolicy } from '../model/look_policy';
import { SessionModel } from '../model/session';
import { nearestCut, soundOf } from '../model/sound';
import type { SoundLevels } from '../model/sound';
import type { CameraRig } from '../view/camera_rig';
import type { ProgramInfo, Seek } from '../wire/types';
import { mark, marks } from '../model/marks';
import { ArrowScale } from '../ui/arrow_scale';
import { copyText, h } from '../ui/dom';
import { sentence } from '../ui/format';
import { eachFrame } from '../ui/frames';
import { helpDialog } from '../ui/help';
import { insetsOf } from '../ui/insets';
import { mountInspect } from '../ui/inspect/mount';
import { inviteDialog } from '../ui/invite';
import { listenToKeys, withoutPanels } from '../ui/keyboard';
import type { KeyActions } from '../ui/keyboard';
import { remember } from '../strings/memory';
import { failurePage, Notice } from '../ui/notice';
import { Flash, noticeText, SESSION_CLOSED } from '../ui/notice_text';
import { OneOpen } from '../ui/one_open';
import { PersonChoice } from '../ui/person_choice';
import { Panel } from './panel';
import { Picture } from '../ui/picture';
import { Poster } from '../ui/poster';
import { mountPrograms } from '../ui/programs/mount';
import { whenFinished } from '../ui/programs/when_finished';
import { mountPast } from '../replay/mount';
import type { PastSwitch } from '../replay/mount';
import { SoundToggle } from '../ui/sound';
import { mountTimeline } from '../ui/timeline/mount';
import type { TimelineSwitch } from '../ui/timeline/mount';
import { TitleBar } from '../ui/title_bar';
import { mountTogether } from '../ui/together/mount';
import type { Together } from '../ui/together/mount';
import { Toolbar } from '../ui/toolbar';

const PANEL_EVERY_MS = 100;
const SHEET_MS = 240; // duration of the bottom sheet's transition (style/phone.css)

export interface SessionPageOptions {
  /** The element that the page fills. */
  app: HTMLElement;
  session: string;
  /** The viewer's name. */
  name: string;
  /** Draws every frame at full quality and gets exact tiles, regardless of speed. */
  fullQuality: boolean;
  /** Part of another page: without bars and panels, and keys open none. */
  embedded: boolean;
  /** Plays the cuts of the session's first program once it has finished. */
  plays: boolean;
}

export class SessionPage {
  readonly model = new SessionModel();
  private readonly canvas_ = h('canvas', {
    class: 'canvas',
    tabindex: '0',
    role: 'img',
    'aria-label': t('3D view of the block and the tools'),
  });
  private readonly overlay_ = h('div', { class: 'overlay', 'aria-hidden': 'true' });
  private readonly notice_ = new Notice(() => this.link_.retryNow());
  private readonly help_ = helpDialog();
  readonly sound = new SoundToggle(() => this.soundLevels_());
  private readonly colors_ = wrenchColors(matchMedia('(prefers-color-scheme: dark)').matches);
  private readonly scale_ = new ArrowScale(this.colors_);
  private readonly poster_: Poster;
  private readonly inviteDialog_: HTMLDialogElement;
  private readonly toolbar_: Toolbar;
  private readonly bar_: TitleBar;
  private readonly panel_: Panel;
  readonly picture: Picture;
  private readonly link_: ViewLink;
  private readonly timeline_: TimelineSwitch;
  private readonly toggleInspect_: () => void;
  readonly carve: CarveSwitch;
  private readonly lookPolicy_ = new LookPolicy();
  private readonly people_: PersonChoice;
  private panelMs_ = 0;
  private contextLost_ = false;
  private readonly flash_ = new Flash();
  private readonly together_: Together;
  private readonly past_: PastSwitch;
  private readonly app_: HTMLElement;
  private readonly session_: string;

  constructor({ app, session, name, fullQuality, embedded, plays }: SessionPageOptions) {
    this.app_ = app;
    this.session_ = session;
    this.picture = new Picture(this.canvas_, this.overlay_, this.model, fullQuality);
    this.past_ = mountPast({
      session,
      model: this.model,
      picture: this.picture,
      seek: (seek) => this.link_.seek(seek),
      isCarving: () => this.carve.isActive() || (this.picture.viewer?.local.size ?? 0) > 0,
    });
    this.link_ = this.makeLink_(name);
    this.link_.start(); // first: the server answers while the page is built
    const host = {
      model: this.model,
      session,
      name: () => this.link_.name,
      picture: this.picture,
      canvas: this.canvas_,
      overlay: this.overlay_,
      oneOpen: new OneOpen(),
      layoutChanged: () => this.resize_(),
      say: (text: string) => this.flash_.say(text),
    };
    this.together_ = mountTogether({
      ...host,
      showCamera: (pose) => this.link_.showCamera(pose),
    });
    this.people_ = new PersonChoice(this.model.participants, this.picture);
    this.panel_ = this.makePanel_();
    this.poster_ = new Poster(session);
    this.inviteDialog_ = inviteDialog(session);
    this.toolbar_ = this.makeToolbar_();
    this.bar_ = new TitleBar(session, {
      copyLink: () => copyText(pageAddress(), () => this.flash_.say(t('Link copied.'))),
      invite: () => this.inviteDialog_.showModal(),
    });
    app.replaceChildren(this.main_(embedded));
    const { element: toolbar } = this.toolbar_;
    const replay = (program: ProgramInfo): void =>
      this.timeline_.playStrokesOf(program.participant);
    const showLine = mountPrograms({ ...host, toolbar, path: host, replay });
    const seek = (seek: Seek): void => this.past_.seek(seek);
    this.timeline_ = mountTimeline({ ...host, toolbar, seek });
    if (plays) whenFinished(this.model.programs, session, replay);
    this.toggleInspect_ = mountInspect({ ...host, toolbar, showLine });
    this.carve = mountCarve({
      ...host,
      toolbar,
      begins: () => {
        this.timeline_.stopPlaying();
        this.past_.leave();
      },
      frame: (nowMs) => this.frame_(nowMs),
    });
    this.listen_(embedded);
    this.resize_();
  }

  /** Draws from now on, at most `picturesPerSecond` if that is not 0 (frameLimit). */
  start(picturesPerSecond: number): void {
    setInterval(() => this.model.liveness.beat(performance.now()), BEAT_MS);
    eachFrame(this.picture, (nowMs) => this.frame_(nowMs), picturesPerSecond);
  }

  private frame_(nowMs: number): void {
    this.picture.tick(nowMs);
    this.sendLook_(nowMs);
    if (nowMs - this.panelMs_ >= PANEL_EVERY_MS) this.updatePanel_(nowMs);
  }

  private get rig_(): CameraRig | undefined {
    return this.picture.viewer?.rig;
  }

  private sendLook_(nowMs: number): void {
    if (this.model.status !== 'connected') return;
    const placed = this.picture.look();
    if (!placed) return;
    const changed = this.lookPolicy_.next(placed.look, placed.distanceMm, nowMs);
    if (changed) this.link_.sendLook(changed);
  }

  private makeLink_(name: string): ViewLink {
    return new ViewLink(
      {
        url: socketUrl(this.session_, 'view'),
        name,
        open: openView,
        probe: (server) => probeSession(this.session_, server),
        look: () => this.picture.look()?.look ?? null,
        needsTiles: () => this.picture.needsTiles(),
        reloadAt,
        nowMs: () => performance.now(),
      },
      {
        greeted: () => mark('hello'),
        served: useServer,
        renamed: (name) => remember('name', name),
        status: (status, reason) => {
          this.model.setStatus(status, reason);
          if (status === 'connected') this.sendLook_(performance.now());
          if (status === 'stopped') this.showStopped_(reason);
        },
        message: (message) => {
          if (message.type === 'state' && this.past_.isShown) {
            this.past_.keep(message);
            return;
          }
          this.model.apply(message);
          if (message.type !== 'welcome') return;
          this.past_.welcomed();
          mark('welcome');
          this.picture.welcome(message);
          this.lookPolicy_.reset();
        },
        tools: (header, tools) => {
          if (!this.past_.isShown) this.model.applyTools(header, tools, performance.now());
        },
        mesh: async (header, glb) => {
          this.model.meshArrived(header, glb.byteLength, performance.now());
          await this.picture.applyMesh(header, glb);
        },
        pinged: () => this.model.liveness.pinged(),
        pong: (sent, received, serverUs) => this.model.pong(sent, received, serverUs),
        late: (isLate) => (this.model.lag.isMissing = isLate),
        problem: (reason) => {
          this.model.addProblem(reason);
          console.warn(reason);
        },
      },
    );
  }

  private makePanel_(): Panel {
    const { element: together } = this.together_;
    return new Panel(this.model, this.session_, this.colors_, this.people_, together, {
      renamed: (name) => this.link_.rename(name),
      viewer: () => this.picture.viewer,
      materialChosen: (preset) => this.picture.setMaterial(preset),
      navigationChosen: (navigation) => this.picture.setNavigation(navigation),
      capMouse: {
        rig: () => this.rig_,
        isBusy: () => this.carve.isActive() || this.carve.vr() !== null,
        say: (text) => this.flash_.say(text),
      },
      layoutChanged: () => this.resize_(),
      toggled: (open) => {
        this.toolbar_.element.classList.toggle('covered', open);
        setTimeout(() => this.rig_?.fit(performance.now()), SHEET_MS);
      },
    });
  }

  private main_(embedded: boolean): HTMLElement {
    return h(
      'main',
      { class: embedded ? 'viewer embedded' : 'viewer' },
      this.canvas_,
      this.poster_.element,
      this.overlay_,
      this.bar_.element,
      this.toolbar_.element,
      this.scale_.element,
      this.panel_.element,
      this.notice_.element,
      this.help_,
      this.inviteDialog_,
    );
  }

  private makeToolbar_(): Toolbar {
    const now = (): number => performance.now();
    return new Toolbar(
      {
        fit: () => this.rig_?.fit(now()),
        iso: () => this.rig_?.preset('iso', now()),
        front: () => this.rig_?.preset('front', now()),
        right: () => this.rig_?.preset('right', now()),
        top: () => this.rig_?.preset('top', now()),
        followNext: () => this.people_.followNext(),
        toggleArrows: () => this.toggleArrows_(),
        help: () => this.help_.showModal(),
      },
      this.sound.button,
    );
  }

  private listen_(embedded: boolean): void {
    const keys: KeyActions = {
      preset: (preset) => this.rig_?.preset(preset, performance.now()),
      fit: () => this.rig_?.fit(performance.now()),
      orbit: (around, up) => this.rig_?.orbit(around, up),
      pan: (right, up) => this.rig_?.pan(right, up),
      zoom: (factor) => this.rig_?.zoom(factor),
      followNext: () => this.people_.followNext(),
      followNone: () => this.picture.follow(null),
      toggleArrows: () => this.toggleArrows_(),
      toggleGrid: () => this.picture.viewer?.toggleGrid(),
      toggleSound: () => this.sound.toggle(),
      toggleTimeline: () => this.timeline_.toggle(),
      toggleInspect: () => this.toggleInspect_(),
      toggleParallel: () => this.toggleParallel_(),
      toggleCarve: () => this.carve.toggle(),
      undo: () => void this.panel_.history.change('undo'),
      redo: () => void this.panel_.history.change('redo'),
      help: () => this.help_.showModal(),
    };
    listenToKeys(embedded ? withoutPanels(keys) : keys);
    window.addEventListener('resize', () => this.resize_());
    window.addEventListener('online', () => this.link_.retryNow());
    window.addEventListener('vite:preloadError', () => this.flash_.say(notLoaded()));
    document.addEventListener('visibilitychange', () => {
      if (!document.hidden) this.link_.retryNow();
    });
    this.canvas_.addEventListener('dblclick', (event) =>
      this.picture.viewer?.lookAtPixel(event.offsetX, event.offsetY),
    );
    this.canvas_.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      this.contextLost_ = true;
    });
    this.canvas_.addEventListener('webglcontextrestored', () => {
      this.contextLost_ = false;
      this.picture.viewer?.touch();
    });
  }

  private resize_(): void {
    const width = Math.max(1, this.app_.clientWidth);
    const height = Math.max(1, this.app_.clientHeight);
    this.picture.resize({ width, height, insets: insetsOf(this.app_, width, height) });
  }

  private updatePanel_(nowMs: number): void {
    this.panelMs_ = nowMs;
    const { participants } = this.model;
    const started = marks.picture !== undefined || this.picture.problem !== '';
    this.panel_.update(nowMs, started);
    this.bar_.update(this.model, nowMs);
    this.poster_.update(this.picture, this.model.state, nowMs);
    this.toolbar_.update({
      hasPicture: this.picture.viewer !== null,
      canFollow: participants.carvers().length > 0,
      follows: this.picture.followed !== null,
      arrowsVisible: this.picture.arrowsVisible,
    });
    this.carve.update();
    this.together_.update();
    this.scale_.update(this.picture, participants.carvers().length > 0);
    const { model, contextLost_: contextLost, flash_: flash } = this;
    const { retryAtMs } = this.link_;
    const hasNoPicture = this.picture.problem !== '';
    const state = { model, retryAtMs, contextLost, hasNoPicture, flash };
    this.notice_.show(noticeText(state, nowMs));
  }

  /** The sound of the followed tool, or of the one nearest to the camera. */
  private soundLevels_(): SoundLevels {
    const { participants, welcome } = this.model;
    const { followed: id } = this.picture;
    const followed = id === null ? undefined : participants.get(id);
    const carvers = followed ? [followed] : participants.carvers();
    const eye = this.picture.look()?.look.eye_mm ?? [0, 0, 0];
    return soundOf(nearestCut(carvers, eye, welcome?.force, performance.now()));
  }

  private showStopped_(reason: string): void {
    if (this.model.welcome) return; // the last picture stays; badge and notice explain
    this.app_.replaceChildren(
      failurePage(t('Session not available'), sentence(reason || SESSION_CLOSED), [
        { label: t('All sessions'), href: '?list' },
        { label: t('Try again'), href: location.search },
      ]),
    );
  }

  private toggleParallel_(): void {
    const { viewer } = this.picture;
    if (viewer) viewer.parallel = !viewer.rig.parallel;
  }

  private toggleArrows_(): void {
    this.picture.arrowsVisible = !this.picture.arrowsVisible;
  }
}
