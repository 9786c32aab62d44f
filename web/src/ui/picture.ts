// SPDX-License-Identifier: Apache-2.0
// The 3D view as the page sees it. It opens once the session was joined, because its code and the
// GPU take time, and a browser without WebGL has none at all. So the user's settings are kept here.

import { computed, signal } from '@preact/signals';
import { workerDecoder } from '../decode/frame_decoder';
import { firstLook } from '../model/first_look';
import type { PlacedLook } from '../model/first_look';
import type { Viewport } from '../model/fit';
import { errorRad } from '../model/look_policy';
import type { StockMaterialPreset } from '../model/materials';
import type { Navigation } from '../model/navigation';
import { posterPlace } from '../model/poster_place';
import type { PosterPlace } from '../model/poster_place';
import { Rest } from '../model/rest';
import type { SessionModel } from '../model/session';
import type { Viewer } from '../view/viewer';
import { changeOf } from '../model/change_of';
import { distance } from '../model/vector';
import { mark, marks } from '../model/marks';
import { t } from '../strings';
import { MESH_SNAPSHOT_LAST } from '../wire/types';
import type { Header, Welcome } from '../wire/types';

/** Without a picture any error is allowed: the server sends as little as it can. */
const ANY_ERROR_RAD = 1;

/** More triangles than this are not asked for where the CPU draws, and where a GPU does. */
const TRIANGLES_MAX = { software: 4e6, hardware: 12e6 };
/** A block that would have more has this part of the usual error at rest. */
const FINE_AT_REST = 0.25;
/** The server draws a picture for a page that has none so long after it joined. */
const POSTER_AFTER_MS = 700;
/** Exact tiles for a file come within this time, or the picture is not made. */
const EXACT_WITHIN_MS = 60_000;

/** Runs the code of the view, which is in a chunk of its own (index.html has it fetched early). */
export type LoadViewer = () => Promise<typeof import('../view/viewer')>;

export class Picture {
  private readonly problem_ = signal('');
  private readonly viewer_ = signal<Viewer | null>(null);
  private readonly exactFor_ = new Set<object>();
  private readonly rest_ = new Rest();
  private restRad_: number | null = null; // the acceptable error at rest; null: the picture moves
  private welcomeMs_: number | null = null; // when the page knew the block first
  private opening_: Promise<void> | null = null;
  private viewport_: Viewport = {
    width: 1,
    height: 1,
    insets: { left: 0, right: 0, top: 0, bottom: 0 },
  };
  private preset_: StockMaterialPreset | null = null;
  private navigation_: Navigation | null = null;
  private readonly followed_ = signal<number | null>(null);
  private readonly arrowsVisible_ = signal(true);

  /** @param fullQuality draw every frame at full quality and get exact tiles, regardless of speed */
  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly overlay: HTMLElement,
    private readonly model: SessionModel,
    private readonly fullQuality: boolean,
    private readonly load: LoadViewer = () => import('../view/viewer'),
    private readonly decode = workerDecoder(),
  ) {}

  /** The view, as a signal's value: null until it is open, and where there is none. */
  get viewer(): Viewer | null {
    return this.viewer_.value;
  }

  /** Why there is no picture, as a signal's value; empty: there is one, or will be. */
  get problem(): string {
    return this.problem_.value;
  }

  /** Opens the view of a session that was joined, or prepares it for one joined again. */
  welcome(welcome: Welcome): void {
    if (this.viewer) this.viewer.welcome(welcome);
    else this.opening_ ??= this.open_();
  }

  /** Resolves when the view of the session that was joined is open, or cannot be opened. */
  async opened(): Promise<void> {
    await this.opening_;
  }

  /** Has all tiles exact, however far away, as long as `user` needs them. */
  needExact(user: object, isNeeded: boolean): void {
    if (isNeeded) this.exactFor_.add(user);
    else this.exactFor_.delete(user);
  }

  /**
   * Calls `use` while all tiles are exact.
   * @throws Error if they have not come in time, or the connection is lost
   */
  async withExactTiles<T>(use: () => Promise<T>): Promise<T> {
    const user = {};
    this.needExact(user, true);
    try {
      await this.whenExact_();
      return await use();
    } finally {
      this.needExact(user, false);
    }
  }

  /** Displays a mesh frame once there is a view; it is decoded while the view opens. */
  async applyMesh(header: Header, glb: Uint8Array): Promise<void> {
    const { tiles } = this.model;
    const { generation } = tiles;
    const [frame] = await Promise.all([this.problem ? null : this.decode(glb), this.opening_]);
    if (generation !== tiles.generation) return; // joined again meanwhile: a new snapshot follows
    this.model.lag.pictured(frame?.motions ?? Infinity);
    if (this.viewer && frame) this.viewer.applyMesh(header, frame);
    else if (header.flags & MESH_SNAPSHOT_LAST) tiles.finishSnapshot();
  }

  /** Where the page looks from; null before the first welcome. */
  look(): PlacedLook | null {
    const { welcome } = this.model;
    if (!welcome) return null;
    const error = this.errorRad_();
    return this.viewer?.look(error) ?? firstLook(welcome, this.viewport_, error);
  }

  /**
   * Where the server's picture stands for the block; undefined: nowhere, because the page has drawn
   * the block, is about to, or looks from elsewhere.
   */
  posterPlace(nowMs: number): PosterPlace | undefined {
    const { welcome } = this.model;
    if (!welcome || marks.block !== undefined) return undefined;
    this.welcomeMs_ ??= nowMs;
    if (nowMs - this.welcomeMs_ < POSTER_AFTER_MS) return undefined;
    const first = firstLook(welcome, this.viewport_, 0);
    const eye = this.look()?.look.eye_mm ?? first.look.eye_mm;
    const isMoved = distance(eye, first.look.eye_mm) > 1e-3 * first.distanceMm;
    return isMoved ? undefined : posterPlace(welcome, this.viewport_);
  }

  /** Resolves once the picture that is being drawn is shown. */
  shown(): Promise<void> {
    return this.viewer?.shown() ?? Promise.resolve();
  }

  /**
   * Resolves when more tiles are of use: at once until the block is there, then once the picture that
   * is being drawn is shown. The server is to mesh no more than the page can show.
   */
  needsTiles(): Promise<void> {
    return this.model.tiles.complete ? this.shown() : Promise.resolve();
  }

  tick(nowMs: number): void {
    this.viewer?.tick(nowMs);
    this.takeRest_(nowMs);
  }

  resize(viewport: Viewport): void {
    this.viewport_ = viewport;
    this.viewer?.resize(viewport);
  }

  /** Of the picture, CSS pixels. */
  get width(): number {
    return this.viewport_.width;
  }

  setMaterial(preset: StockMaterialPreset): void {
    this.preset_ = preset;
    this.viewer?.setMaterial(preset);
  }

  setNavigation(navigation: Navigation): void {
    this.navigation_ = navigation;
    if (this.viewer) this.viewer.rig.navigation = navigation;
  }

  /** The participant whose tool the camera follows, as a signal's value. */
  get followed(): number | null {
    return this.followed_.value;
  }

  follow(participant: number | null): void {
    this.followed_.value = participant;
    this.viewer?.follow(participant);
  }

  get arrowsVisible(): boolean {
    return this.arrowsVisible_.value;
  }

  set arrowsVisible(visible: boolean) {
    this.arrowsVisible_.value = visible;
    if (this.viewer) this.viewer.arrowsVisible = visible;
  }

  /** Whether the tiles are exact, and are to be: a picture that moves is not to have them. */
  get isExact(): boolean {
    return this.errorRad_() === 0 && this.model.tiles.exact;
  }

  private async whenExact_(): Promise<void> {
    const { model } = this;
    const outcome = computed(() =>
      model.tiles.exact ? 'exact' : model.status === 'connected' ? 'waiting' : 'lost',
    );
    const isWaiting = outcome.peek() === 'waiting';
    const end = isWaiting ? await changeOf(outcome, EXACT_WITHIN_MS) : outcome.peek();
    if (end === 'exact') return;
    throw new Error(t('The full detail has not arrived. Check the connection and try again.'));
  }

  private errorRad_(): number {
    if (this.problem) return ANY_ERROR_RAD;
    if (this.fullQuality || this.exactFor_.size > 0) return 0;
    return this.restRad_ ?? this.movingRad_;
  }

  private get movingRad_(): number {
    return errorRad(this.viewport_.height, window.devicePixelRatio);
  }

  private takeRest_(nowMs: number): void {
    const { viewer } = this;
    const { tiles, state } = this.model;
    if (!viewer || !tiles.complete) {
      this.rest_.reset();
      this.restRad_ = null;
      return;
    }
    const { look, distanceMm } = viewer.look(0);
    const { isFast } = viewer;
    const motions = state?.motions ?? 0;
    if (!this.rest_.take({ eyeMm: look.eye_mm, distanceMm, motions, isFast }, nowMs)) {
      this.restRad_ = null;
    } else if (this.restRad_ === null) {
      const most = viewer.stage.drawsInSoftware ? TRIANGLES_MAX.software : TRIANGLES_MAX.hardware;
      this.restRad_ = tiles.exactTriangles <= most ? 0 : FINE_AT_REST * this.movingRad_;
    }
  }

  private async open_(): Promise<void> {
    try {
      const { Viewer } = await this.load();
      mark('view');
      const viewer = new Viewer(this.canvas, this.overlay, this.model, this.fullQuality);
      viewer.resize(this.viewport_);
      if (this.preset_) viewer.setMaterial(this.preset_);
      if (this.navigation_) viewer.rig.navigation = this.navigation_;
      viewer.arrowsVisible = this.arrowsVisible_.peek();
      viewer.follow(this.followed_.value);
      if (this.model.welcome) viewer.welcome(this.model.welcome);
      this.viewer_.value = viewer;
    } catch (problem) {
      console.warn(problem);
      this.problem_.value = (problem as Error).message;
    }
  }
}
