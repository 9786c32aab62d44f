// SPDX-License-Identifier: Apache-2.0
// The page of one session: connects link, model, view and panels.

import { computed, signal } from '@preact/signals';
import { t } from '../strings';
import { CarvePart } from '../carve/part';
import { probeSession } from '../link/api';
import { socketUrl } from '../link/address';
import { openView } from '../link/early_socket';
import { notePerson, personIn } from '../link/kept_person';
import { reloadAt } from '../link/redirect';
import { notLoaded, pageAddress, useServer } from '../link/request';
import { ViewLink } from '../link/view_link';
import { wrenchColors } from '../model/arrow_scale';
import { BEAT_MS } from '../model/liveness';
import { LookPolicy } from '../model/look_policy';
import { SessionModel } from '../model/session';
import { nearestCut, soundOf } from '../model/sound';
import type { SoundLevels } from '../model/sound';
import type { ProgramInfo, Seek } from '../wire/types';
import { mark } from '../model/marks';
import type { Action, ButtonAction } from '../ui/actions';
import { ArrowScale } from '../ui/arrow_scale';
import { copyText } from '../ui/clipboard';
import { sentence } from '../ui/format';
import { eachFrame } from '../ui/frames';
import { Help, helpAction } from '../ui/help';
import { historyActions } from '../ui/history/actions';
import { History } from '../ui/history/state';
import { ICONS } from '../ui/icons';
import { InspectPart } from '../ui/inspect/part';
import { InviteDialog } from '../ui/invite';
import { listenToKeys } from '../ui/keyboard';
import { MainActions } from '../ui/main_actions';
import { shareAction } from '../ui/share';
import { remember } from '../strings/memory';
import { Failure, Notice } from '../ui/notice';
import { Flash, noticeText, SESSION_CLOSED } from '../ui/notice_text';
import { OneOpen } from '../ui/one_open';
import { PersonChoice } from '../ui/person_choice';
import { Panel } from './panel';
import { Picture } from '../ui/picture';
import { Poster } from '../ui/poster';
import { ProgramsPart } from '../ui/programs/part';
import { whenFinished } from '../ui/programs/when_finished';
import { pastOf } from '../replay/part';
import type { Past } from '../replay/part';
import { Shell } from '../ui/shell';
import { Sound } from '../ui/sound';
import { TakeHomePart } from '../ui/take_home/part';
import { TimelinePart } from '../ui/timeline/part';
import { TitleBar } from '../ui/title_bar';
import { TogetherPart } from '../ui/together/part';
import { Toolbar } from '../ui/toolbar';
import { cameraKeys, keyActions, toolActions, viewActions } from '../ui/view_actions';

const PANEL_EVERY_MS = 100;

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
  /** Begins to carve by hand once there is a picture. */
  carves: boolean;
}

export class SessionPage {
  readonly model = new SessionModel();
  readonly picture: Picture;
  readonly carve: CarvePart;
  readonly sound = new Sound(() => this.soundLevels_());
  private readonly session_: string;
  private readonly shell_: Shell;
  private readonly link_: ViewLink;
  private readonly past_: Past;
  private readonly people_: PersonChoice;
  private readonly history_: History;
  private readonly together_: TogetherPart;
  private readonly takeHome_: TakeHomePart;
  private readonly timeline_: TimelinePart;
  private readonly inspect_: InspectPart;
  private readonly programs_: ProgramsPart;
  private readonly lookPolicy_ = new LookPolicy();
  private readonly flash_ = new Flash();
  private readonly isHelpOpen_ = signal(false);
  private readonly isInviteOpen_ = signal(false);
  private readonly contextLost_ = signal(false);
  /** The time at which the page samples forces and delays, ms. */
  private readonly nowMs_ = signal(0);
  private readonly notice_ = computed(() => {
    const { model, flash_: flash } = this;
    const hasNoPicture = this.picture.problem !== '';
    const { retryAtMs } = this.link_;
    const contextLost = this.contextLost_.value;
    return noticeText({ model, retryAtMs, contextLost, hasNoPicture, flash }, this.nowMs_.value);
  });

  constructor(options: SessionPageOptions) {
    const { app, session, name, fullQuality, embedded } = options;
    this.session_ = session;
    const shell = new Shell(app, embedded);
    this.shell_ = shell;
    this.picture = new Picture(shell.canvas, shell.overlay, this.model, fullQuality);
    shell.resized = (viewport) => this.picture.resize(viewport);
    this.past_ = pastOf({
      session,
      model: this.model,
      picture: this.picture,
      seek: (seek) => this.link_.seek(seek),
      isCarving: () => this.carve.isActive || (this.picture.viewer?.local.size ?? 0) > 0,
    });
    this.link_ = this.makeLink_(name);
    this.link_.start(); // first: the server answers while the page is built
    this.people_ = new PersonChoice(this.model.participants, this.picture);
    this.history_ = new History(this.model, session, this.people_);
    this.takeHome_ = new TakeHomePart(this.model, session);
    const host = this.host_();
    this.together_ = new TogetherPart({
      ...host,
      showCamera: (pose) => this.link_.showCamera(pose),
    });
    const replay = (program: ProgramInfo): void =>
      this.timeline_.playStrokesOf(program.participant);
    this.programs_ = new ProgramsPart({ ...host, path: host, replay });
    const seek = (seek: Seek): void => this.past_.seek(seek);
    this.timeline_ = new TimelinePart({ ...host, seek });
    if (options.plays) whenFinished(this.model.programs, session, replay);
    this.inspect_ = new InspectPart({
      ...host,
      showLine: (place) => this.programs_.showLine(place),
    });
    this.carve = new CarvePart({
      ...host,
      begins: () => {
        this.timeline_.stopPlaying();
        this.past_.leave();
      },
      frame: (nowMs) => this.frame_(nowMs),
    });
    if (options.carves) this.carve.beginSoon();
    const actions = this.actions_();
    this.show_(actions);
    this.listen_(
      embedded ? actions.ofPicture : [...actions.main, ...actions.buttons, ...actions.keys],
    );
    shell.layoutChanged();
  }

  /** Draws from now on, at most `picturesPerSecond` if that is not 0 (frameLimit). */
  start(picturesPerSecond: number): void {
    setInterval(() => this.model.liveness.beat(performance.now()), BEAT_MS);
    eachFrame(this.picture, (nowMs) => this.frame_(nowMs), picturesPerSecond);
  }

  private frame_(nowMs: number): void {
    this.picture.tick(nowMs);
    this.sendLook_(nowMs);
    if (nowMs - this.nowMs_.peek() < PANEL_EVERY_MS) return;
    this.nowMs_.value = nowMs;
    this.together_.update();
  }

  private sendLook_(nowMs: number): void {
    if (this.model.status !== 'connected') return;
    const placed = this.picture.look();
    if (!placed) return;
    const changed = this.lookPolicy_.next(placed.look, placed.distanceMm, nowMs);
    if (changed) this.link_.sendLook(changed);
  }

  /** The parts of the page that the others use. */
  private host_() {
    const { shell_: shell, model, picture, session_: session } = this;
    return {
      ...{ model, session, picture, shell, canvas: shell.canvas, overlay: shell.overlay },
      name: () => this.link_.name,
      oneOpen: new OneOpen(),
      say: (text: string) => this.flash_.say(text),
    };
  }

  private makeLink_(name: string): ViewLink {
    return new ViewLink(
      {
        url: socketUrl(this.session_, 'view'),
        name,
        color: () => personIn(this.session_).color,
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
          notePerson(this.session_, { color: message.color });
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

  /** The actions with a button, in their order; those by keys; those that change the picture only. */
  private actions_() {
    const { picture, model } = this;
    const views = viewActions(picture);
    const tools = toolActions(picture, model.participants, this.people_);
    const keys = keyActions(picture);
    const panels = [this.programs_, this.inspect_, this.timeline_];
    const [undo, redo] = historyActions(this.history_);
    const main: ButtonAction[] = [
      this.carve.action,
      {
        ...{ ...undo, icon: ICONS.undo },
        isShown: () => undo.whyNot?.() === '' && !this.shell_.isCarving.value,
      },
      shareAction(model, {
        copy: () => copyText(pageAddress(), () => this.flash_.say(t('Link copied.'))),
        invite: () => (this.isInviteOpen_.value = true),
      }),
      this.takeHome_.action,
    ];
    const buttons: ButtonAction[] = [
      ...panels.map(({ action }) => action),
      ...views,
      ...tools,
      this.sound.action,
      helpAction(this.isHelpOpen_),
      this.carve.vr.action,
    ];
    return {
      ...{ main, buttons },
      keys: [...keys, undo, redo],
      ofPicture: [...views, ...tools, ...keys, this.sound.action],
    };
  }

  private show_({ main, buttons }: Record<'main' | 'buttons', readonly ButtonAction[]>): void {
    const { model, picture, session_: session, shell_: shell, nowMs_: nowMs } = this;
    const colors = wrenchColors(matchMedia('(prefers-color-scheme: dark)').matches);
    shell.show(
      <>
        <Poster {...{ model, session, picture, nowMs }} />
        {this.carve.marks()}
      </>,
      <>
        {this.timeline_.border()}
        <TitleBar {...{ model, session, nowMs }} />
        <MainActions shell={shell} actions={main} />
        <Toolbar shell={shell} actions={buttons} />
        <ArrowScale {...{ model, picture, colors, nowMs }} />
        <Panel
          {...{ shell, model, session, picture, colors, nowMs }}
          choice={this.people_}
          history={this.history_}
          together={this.together_}
          renamed={(name) => this.link_.rename(name)}
          capMouse={{
            rig: () => picture.viewer?.rig,
            isBusy: () => this.carve.isActive || this.carve.vrState !== null,
            say: (text) => this.flash_.say(text),
          }}
        />
        <Notice notice={this.notice_} act={() => this.link_.retryNow()} />
        <Help isOpen={this.isHelpOpen_} />
        <InviteDialog session={session} isOpen={this.isInviteOpen_} />
        {this.takeHome_.dialog()}
        {this.together_.dialog()}
        {this.timeline_.view()}
        {this.programs_.view()}
        {this.inspect_.view()}
        {this.carve.bar()}
      </>,
    );
  }

  private listen_(actions: readonly Action[]): void {
    const { canvas } = this.shell_;
    listenToKeys(cameraKeys(this.picture), actions);
    window.addEventListener('resize', this.shell_.layoutChanged);
    window.addEventListener('online', () => this.link_.retryNow());
    window.addEventListener('vite:preloadError', () => this.flash_.say(notLoaded()));
    document.addEventListener('visibilitychange', () => {
      if (!document.hidden) this.link_.retryNow();
    });
    canvas.addEventListener('dblclick', (event) =>
      this.picture.viewer?.lookAtPixel(event.offsetX, event.offsetY),
    );
    canvas.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      this.contextLost_.value = true;
    });
    canvas.addEventListener('webglcontextrestored', () => {
      this.contextLost_.value = false;
      this.picture.viewer?.touch();
    });
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
    this.shell_.end(
      <Failure
        title={t('Session not available')}
        text={sentence(reason || SESSION_CLOSED)}
        actions={[
          { label: t('All sessions'), href: '?list' },
          { label: t('Try again'), href: location.search },
        ]}
      />,
    );
  }
}
