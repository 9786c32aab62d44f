// SPDX-License-Identifier: Apache-2.0
// The page of one session: connects link, model, view and panels.

import { probeSession } from '../link/api';
import { redirectTarget } from '../link/redirect';
import { ViewLink } from '../link/view_link';
import type { Socket } from '../link/view_link';
import { LookPolicy } from '../model/look_policy';
import { SessionModel } from '../model/session';
import { nearestCut, soundOf } from '../model/sound';
import type { SoundLevels } from '../model/sound';
import { Viewer } from '../view/viewer';
import type { Insets } from '../view/camera_rig';
import { FORCE_COLOR, TORQUE_COLOR } from '../view/wrench_view';
import { Badge } from './badge';
import { h, iconButton, setText } from './dom';
import { figure, sentence } from './format';
import { helpDialog } from './help';
import { inviteDialog } from './invite';
import { ICONS } from './icons';
import { listenToKeys } from './keyboard';
import { failurePage, Notice } from './notice';
import { mountPrograms } from './programs/mount';
import { Panel } from './panel';
import { SoundToggle } from './sound';

const SESSION_CLOSED = 'The server closed the session';
const PANEL_EVERY_MS = 100;
const SHEET_MS = 240; // duration of the bottom sheet's transition (style/phone.css)

export class SessionPage {
  readonly model = new SessionModel();
  private readonly canvas_ = h('canvas', {
    class: 'canvas',
    tabindex: '0',
    role: 'img',
    'aria-label': 'The block and the tools, in 3D',
  });
  private readonly overlay_ = h('div', { class: 'overlay', 'aria-hidden': 'true' });
  private readonly notice_ = new Notice();
  private readonly badge_ = new Badge();
  private readonly scale_ = h('div', { class: 'arrow-scale', 'aria-hidden': 'true' });
  private readonly help_ = helpDialog();
  readonly sound = new SoundToggle(() => this.soundLevels_());
  private readonly role_ = h('span', { class: 'role', hidden: '' });
  private readonly invite_ = iconButton(ICONS.invite, 'Invite people', '', () =>
    this.inviteDialog_.showModal(),
  );
  private readonly inviteDialog_: HTMLDialogElement;
  private readonly toolbar_: HTMLElement;
  private readonly bar_: HTMLElement;
  private readonly panel_: Panel;
  private readonly viewer_: Viewer;
  private readonly link_: ViewLink;
  private readonly lookPolicy_ = new LookPolicy();
  private selected_: number | null = null;
  private panelMs_ = 0;
  private contextLost_ = false;

  /** Throws if WebGL is not available. */
  constructor(
    private readonly app: HTMLElement,
    private readonly session: string,
    name: string,
    fixedQuality: boolean,
  ) {
    this.viewer_ = new Viewer(this.canvas_, this.overlay_, this.model, fixedQuality);
    this.panel_ = new Panel(
      this.model,
      session,
      { force: FORCE_COLOR, torque: TORQUE_COLOR },
      {
        personPressed: (id) => this.personPressed_(id),
        materialChosen: (preset) => this.viewer_.setMaterial(preset),
        layoutChanged: () => this.resize_(),
        toggled: (open) => {
          this.toolbar_.classList.toggle('covered', open);
          setTimeout(() => this.viewer_.rig.fit(performance.now()), SHEET_MS);
        },
      },
    );
    this.inviteDialog_ = inviteDialog(session);
    this.toolbar_ = this.makeToolbar_();
    this.bar_ = this.makeBar_();
    this.link_ = this.makeLink_(name);
    app.replaceChildren(
      h(
        'main',
        { class: 'viewer' },
        this.canvas_,
        this.overlay_,
        this.bar_,
        this.toolbar_,
        this.scale_,
        this.panel_.element,
        this.notice_.element,
        this.help_,
        this.inviteDialog_,
      ),
    );
    mountPrograms(this.model, session, this.toolbar_);
    this.listen_();
    this.resize_();
  }

  start(): void {
    this.link_.start();
    const frame = (nowMs: number): void => {
      this.viewer_.tick(nowMs);
      this.sendLook_(nowMs);
      if (nowMs - this.panelMs_ >= PANEL_EVERY_MS) this.updatePanel_(nowMs);
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  /** The participant whose tool is followed, or null. */
  get followed(): number | null {
    return this.viewer_.followed;
  }

  private sendLook_(nowMs: number): void {
    if (this.model.status !== 'connected') return;
    const { look, distanceMm } = this.viewer_.look();
    const changed = this.lookPolicy_.next(look, distanceMm, nowMs);
    if (changed) this.link_.sendLook(changed);
  }

  private makeLink_(name: string): ViewLink {
    const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
    return new ViewLink(
      {
        url: `${scheme}://${location.host}/v1/sessions/${encodeURIComponent(this.session)}/view`,
        name,
        open: (url, protocol) => new WebSocket(url, protocol) as unknown as Socket,
        probe: () => probeSession(this.session),
        look: () => (this.model.welcome ? this.viewer_.look().look : null),
        follow: (redirect) => {
          const target = redirectTarget(location.href, redirect);
          if (target !== null) location.assign(target);
          return target !== null;
        },
        nowMs: () => performance.now(),
      },
      {
        status: (status, reason) => {
          this.model.setStatus(status, reason);
          if (status === 'stopped') this.showStopped_(reason);
        },
        message: (message) => {
          this.model.apply(message);
          if (message.type !== 'welcome') return;
          this.viewer_.welcome(message);
          this.lookPolicy_.reset();
        },
        tools: (header, tools) => this.model.applyTools(header, tools, performance.now()),
        mesh: async (header, glb) => {
          this.model.meshArrived(header, glb.byteLength, performance.now());
          await this.viewer_.applyMesh(header, glb);
        },
        pong: (sent, received, serverUs) => this.model.clock.pong(sent, received, serverUs),
        problem: (reason) => {
          this.model.addProblem(reason);
          console.warn(reason);
        },
      },
    );
  }

  private makeBar_(): HTMLElement {
    const copy = iconButton(ICONS.link, 'Copy a link to this session', '', () => {
      const clipboard = navigator.clipboard as Clipboard | undefined; // undefined on plain HTTP
      void clipboard?.writeText(location.href).then(() => this.flash_('Link copied.'));
    });
    this.invite_.hidden = true;
    const home = h(
      'a',
      { class: 'brand', href: '?list', 'aria-label': 'Kerf: all sessions' },
      h('img', { src: './icon.svg', alt: '', width: '28', height: '28' }),
      'Kerf',
    );
    return h(
      'header',
      { class: 'bar' },
      home,
      h('h1', { class: 'session-name', title: this.session }, this.session),
      this.role_,
      copy,
      this.invite_,
      this.badge_.element,
    );
  }

  private makeToolbar_(): HTMLElement {
    const view = this.viewer_;
    const now = (): number => performance.now();
    return h(
      'div',
      { class: 'toolbar', role: 'toolbar', 'aria-label': 'View' },
      iconButton(ICONS.fit, 'Fit', 'F', () => view.rig.fit(now())),
      iconButton(ICONS.iso, 'Three-quarter view', '0', () => view.rig.preset('iso', now())),
      iconButton(ICONS.front, 'Front', '1', () => view.rig.preset('front', now())),
      iconButton(ICONS.right, 'Right', '3', () => view.rig.preset('right', now())),
      iconButton(ICONS.top, 'Top', '7', () => view.rig.preset('top', now())),
      iconButton(ICONS.follow, 'Follow the next tool', 'N', () => this.followNext_()),
      iconButton(ICONS.arrows, 'Force and torque arrows', 'A', () => this.toggleArrows_()),
      this.sound.button,
      iconButton(ICONS.help, 'Keyboard and pointer', '?', () => this.help_.showModal()),
    );
  }

  private listen_(): void {
    const { rig, stage } = this.viewer_;
    listenToKeys({
      preset: (preset) => rig.preset(preset, performance.now()),
      fit: () => rig.fit(performance.now()),
      orbit: (around, up) => rig.orbit(around, up),
      pan: (right, up) => rig.pan(right, up),
      zoom: (factor) => rig.zoom(factor),
      followNext: () => this.followNext_(),
      followNone: () => this.viewer_.follow(null),
      toggleArrows: () => this.toggleArrows_(),
      toggleGrid: () => {
        stage.gridVisible = !stage.gridVisible;
        this.viewer_.touch();
      },
      toggleSound: () => this.sound.toggle(),
      help: () => this.help_.showModal(),
    });
    window.addEventListener('resize', () => this.resize_());
    window.addEventListener('online', () => this.link_.retryNow());
    this.canvas_.addEventListener('dblclick', (event) =>
      this.viewer_.lookAtPixel(event.offsetX, event.offsetY),
    );
    this.canvas_.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      this.contextLost_ = true;
    });
    this.canvas_.addEventListener('webglcontextrestored', () => {
      this.contextLost_ = false;
      this.viewer_.touch();
    });
  }

  private resize_(): void {
    const width = Math.max(1, this.app.clientWidth);
    const height = Math.max(1, this.app.clientHeight);
    this.viewer_.resize(width, height, this.insets_(width, height));
  }

  /** What the panels cover of the picture. */
  private insets_(width: number, height: number): Insets {
    const panel = this.panel_.element.getBoundingClientRect();
    const bar = this.bar_.getBoundingClientRect();
    const sheet = panel.width > 0.9 * width;
    return sheet
      ? {
          left: 0,
          right: 0,
          top: bar.bottom,
          bottom: Math.min(0.75 * height, Math.max(0, height - panel.top)),
        }
      : { left: 0, right: Math.max(0, width - panel.left), top: bar.bottom, bottom: 24 };
  }

  private updatePanel_(nowMs: number): void {
    this.panelMs_ = nowMs;
    const { participants } = this.model;
    if (this.selected_ === null || !participants.get(this.selected_)) {
      this.selected_ = participants.carvers()[0]?.info.participant ?? null;
    }
    if (this.followed !== null && !participants.get(this.followed)) this.viewer_.follow(null);
    this.panel_.update(this.selected_, this.followed, nowMs);
    this.badge_.update(this.model, nowMs);
    const scaleVisible = participants.carvers().length > 0 && this.viewer_.arrowsVisible;
    this.scale_.hidden = !scaleVisible;
    if (scaleVisible) this.updateScale_();
    this.updateRole_();
    this.notice_.show(this.noticeText_(nowMs));
  }

  /** Shows who this viewer is, and offers what that role may do. */
  private updateRole_(): void {
    const { welcome, participants } = this.model;
    const own = welcome ? participants.get(welcome.participant)?.info.role : undefined;
    const role = own ?? welcome?.role;
    this.role_.hidden = role === undefined;
    setText(this.role_, role ?? '');
    this.invite_.hidden = welcome?.may?.includes('invite') !== true;
  }

  /** The sound of the followed tool, or of the one nearest to the camera. */
  private soundLevels_(): SoundLevels {
    const { participants, welcome } = this.model;
    const followed = this.followed === null ? undefined : participants.get(this.followed);
    const carvers = followed ? [followed] : participants.carvers();
    const eye = this.viewer_.look().look.eye_mm;
    return soundOf(nearestCut(carvers, eye, welcome?.force, performance.now()));
  }

  private updateScale_(): void {
    const { forceFullN, torqueFullNmm } = this.viewer_.arrowScale;
    if (this.scale_.childElementCount === 0) {
      this.scale_.append(
        h('span', { style: `--line:${FORCE_COLOR}` }),
        h('span', { style: `--line:${TORQUE_COLOR}` }),
      );
    }
    setText(this.scale_.children[0] as HTMLElement, `${figure(forceFullN)} N`);
    setText(this.scale_.children[1] as HTMLElement, `${figure(torqueFullNmm)} N·mm`);
  }

  private flashText_ = '';
  private flashUntilMs_ = 0;

  private flash_(text: string): void {
    this.flashText_ = text;
    this.flashUntilMs_ = performance.now() + 2500;
  }

  private noticeText_(nowMs: number): string {
    const { status, statusReason, tiles } = this.model;
    if (this.contextLost_)
      return 'The graphics device was lost. Drawing resumes when the browser restores it.';
    if (status === 'reconnecting')
      return `${sentence(statusReason || 'The connection was lost')} Reconnecting…`;
    if (status === 'stopped')
      return `${sentence(statusReason || SESSION_CLOSED)} The last picture stays on screen.`;
    if (status === 'connecting') return 'Connecting…';
    if (!tiles.complete) return 'Loading the block…';
    return nowMs < this.flashUntilMs_ ? this.flashText_ : '';
  }

  private showStopped_(reason: string): void {
    if (this.model.welcome) return; // the last picture stays; badge and notice explain
    this.app.replaceChildren(
      failurePage('Session not available', sentence(reason || SESSION_CLOSED), [
        { label: 'All sessions', href: '?list' },
        { label: 'Try again', href: location.search },
      ]),
    );
  }

  private personPressed_(id: number): void {
    this.selected_ = id;
    this.viewer_.follow(this.followed === id ? null : id);
  }

  private followNext_(): void {
    const ids = this.model.participants.carvers().map((p) => p.info.participant);
    const next = ids[ids.indexOf(this.followed ?? -1) + 1] ?? null;
    if (next !== null) this.selected_ = next;
    this.viewer_.follow(next);
  }

  private toggleArrows_(): void {
    this.viewer_.arrowsVisible = !this.viewer_.arrowsVisible;
  }
}
