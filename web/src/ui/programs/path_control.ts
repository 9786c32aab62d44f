// SPDX-License-Identifier: Apache-2.0
// The path of the selected program in the picture: shown or not, how far it has come, and the place of
// a line in both directions.

import { batch, computed, signal } from '@preact/signals';
import { t } from '../../strings';
import { Matrix4, Vector3 } from 'three';
import {
  feedCurveOf,
  nearestInPicture,
  placeAt,
  pointOf,
  pointsOfLine,
  reached,
} from '../../model/program_path';
import type { FeedCurve, ProgramPath } from '../../model/program_path';
import { PathView } from '../../view/path_view';
import type { ProgramInfo, Vec3 } from '../../wire/types';
import { lengthText } from '../../model/measure';
import type { Picture } from '../picture';

const NEAR_PX = 10;
const TAP_PX = 5;
export interface PathHost {
  picture: Picture;
  canvas: HTMLCanvasElement;
  overlay: HTMLElement;
}

export class PathControl {
  /** A place near the path was pressed in the picture. */
  pressed: (line: number) => void = () => undefined;
  /** Whether the user wants to see the path. */
  readonly isWanted = signal(true);
  /** Why there is no path, or how accurate it is; empty: exact. */
  readonly note = signal('');
  private view_: PathView | null = null;
  private program_: number | null = null;
  private readonly path_ = signal<ProgramPath | null>(null);
  private readonly feeds_ = computed(() => this.path_.value && feedCurveOf(this.path_.value));
  private isOpen_ = false;
  private pressedAt_: { x: number; y: number } | null = null;
  /** To be marked when the path has come. */
  private wanted_: { line: number; place: Vec3 | undefined } | null = null;

  /** @param ask for the path of a program */
  constructor(
    private readonly host: PathHost,
    private readonly ask: (program: number) => Promise<ProgramPath>,
  ) {
    const { canvas } = host;
    canvas.addEventListener('pointerdown', (event) => {
      this.pressedAt_ = event.isPrimary ? { x: event.offsetX, y: event.offsetY } : null;
    });
    canvas.addEventListener('pointerup', ({ button, offsetX: x, offsetY: y }) => {
      const { pressedAt_: at } = this;
      if (at && button === 0 && Math.hypot(x - at.x, y - at.y) < TAP_PX) this.press_(x, y);
    });
  }

  /** The path is drawn while the panel is open. */
  setOpen(open: boolean): void {
    this.isOpen_ = open;
    this.draw_();
  }

  want(isWanted: boolean): void {
    this.isWanted.value = isWanted;
    this.draw_();
  }

  /** Shows the path of another program; null: of none. */
  select(program: number | null): void {
    if (program === this.program_) return;
    this.program_ = program;
    this.path_.value = this.wanted_ = null;
    this.draw_();
    if (program === null) return;
    this.ask(program).then(
      (path) => {
        if (this.program_ !== program) return;
        this.show(path);
        if (this.wanted_) this.markLine(this.wanted_.line, this.wanted_.place);
      },
      (problem: unknown) => {
        this.note.value = (problem as Error).message;
      },
    );
  }

  /** Takes how far the program has come. */
  update({ id, state, line, motions, motions_done }: ProgramInfo): void {
    if (id !== this.program_) return;
    this.reach(state === 'queued' ? 0 : motions_done, motions, line);
  }

  /** So many of the program's motions are done, the last one of a line. */
  reach(done: number, motions: number, line: number): void {
    const path = this.path_.value;
    if (!path || !this.view_) return;
    const share = motions > 0 ? done / motions : 0;
    this.view_.setReached(done === 0 ? -1 : reached(path, line, share));
  }

  /** Shows a path that was not asked for; null: none. */
  show(path: ProgramPath | null): void {
    batch(() => {
      this.path_.value = path;
      this.draw_(); // before an effect says how much of it is done
    });
  }

  /** Marks the place of a line, or a place that belongs to it. */
  markLine(line: number, place?: Vec3): void {
    const path = this.path_.peek();
    this.wanted_ = path ? null : { line, place };
    const points = path && pointsOfLine(path, line);
    if (path && points) this.view_?.mark(points, place ?? pointOf(path, points[1]));
  }

  /** Moves a place to the middle of the picture. */
  lookAt(place: Vec3): void {
    this.host.picture.viewer?.rig.lookAt(new Vector3(...place), performance.now());
  }

  /** Marks where the tool is at a time of the program. Returns the line; null: there is no path. */
  markTime(timeS: number): number | null {
    const path = this.path_.peek();
    const place = path && placeAt(path, timeS);
    if (!path || !place) return null;
    this.view_?.mark([place.point, place.point], place.tip);
    return path.lines[place.point]!;
  }

  /** The feed along the path, as a signal's value; null without a path. */
  get feeds(): FeedCurve | null {
    return this.feeds_.value;
  }

  private get isShown_(): boolean {
    return this.isOpen_ && this.isWanted.peek() && this.path_.peek() !== null;
  }

  private draw_(): void {
    const { viewer } = this.host.picture;
    if (viewer) this.view_ ??= new PathView(viewer, this.host.overlay);
    const path = this.path_.peek();
    this.view_?.show(this.isShown_ ? path : null);
    const error = path?.errorMm ?? 0;
    this.note.value = error > 0 ? t('accurate to {0}', lengthText(error, 'mm')) : '';
  }

  private press_(x: number, y: number): void {
    const { viewer } = this.host.picture;
    const path = this.path_.peek();
    if (!this.isShown_ || !viewer || !path) return;
    const { eye } = viewer.rig;
    const matrix = new Matrix4().multiplyMatrices(eye.projectionMatrix, eye.matrixWorldInverse);
    const { clientWidth: width, clientHeight: height } = this.host.canvas;
    const n = nearestInPicture(path, matrix.elements, { width, height }, { x, y }, NEAR_PX);
    if (n < 0) return;
    this.view_?.mark([n, n], pointOf(path, n));
    this.pressed(path.lines[n]!);
  }
}
