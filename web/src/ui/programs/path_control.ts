// SPDX-License-Identifier: Apache-2.0
// The path of the selected program in the picture: shown or not, how far it has come, and the place of
// a line in both directions.

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
import { PATH_COLORS, PathView } from '../../view/path_view';
import type { ProgramInfo, Vec3 } from '../../wire/types';
import { h, setText } from '../dom';
import { lengthText } from '../../model/measure';
import type { Picture } from '../picture';

const NEAR_PX = 10;
const TAP_PX = 5;
const LEGEND = [
  ['past', t('done')],
  ['future', t('to do')],
  ['rapid', t('rapid')],
] as const;

export interface PathHost {
  picture: Picture;
  canvas: HTMLCanvasElement;
  overlay: HTMLElement;
}

export class PathControl {
  /** A place near the path was pressed in the picture. */
  pressed: (line: number) => void = () => undefined;
  private readonly shown_ = h('input', { type: 'checkbox', checked: '' });
  private readonly note_ = h('span', { class: 'quiet' });
  readonly element = h(
    'p',
    { class: 'program-path' },
    h('label', {}, this.shown_, t(' Show path')),
    ...LEGEND.map(([name, text]) =>
      h('span', { class: `path-key ${name}`, style: `--line:${PATH_COLORS[name]}` }, text),
    ),
    this.note_,
  );
  private view_: PathView | null = null;
  private program_: number | null = null;
  private path_: ProgramPath | null = null;
  private feeds_: FeedCurve | null = null;
  private isOpen_ = false;
  private pressedAt_: { x: number; y: number } | null = null;
  /** To be marked when the path has come. */
  private wanted_: { line: number; place: Vec3 | undefined } | null = null;

  /** @param ask for the path of a program */
  constructor(
    private readonly host: PathHost,
    private readonly ask: (program: number) => Promise<ProgramPath>,
  ) {
    this.shown_.addEventListener('change', () => this.draw_());
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

  /** Shows the path of another program; null: of none. */
  select(program: number | null): void {
    if (program === this.program_) return;
    this.program_ = program;
    this.path_ = this.feeds_ = this.wanted_ = null;
    this.draw_();
    if (program === null) return;
    this.ask(program).then(
      (path) => {
        if (this.program_ !== program) return;
        this.path_ = path;
        this.draw_();
        if (this.wanted_) this.markLine(this.wanted_.line, this.wanted_.place);
      },
      (problem: unknown) => {
        setText(this.note_, (problem as Error).message);
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
    if (!this.path_ || !this.view_) return;
    const share = motions > 0 ? done / motions : 0;
    this.view_.setReached(done === 0 ? -1 : reached(this.path_, line, share));
  }

  /** Shows a path that was not asked for; null: none. */
  show(path: ProgramPath | null): void {
    this.path_ = path;
    this.draw_();
  }

  /** Marks the place of a line, or a place that belongs to it. */
  markLine(line: number, place?: Vec3): void {
    this.wanted_ = this.path_ ? null : { line, place };
    const points = this.path_ && pointsOfLine(this.path_, line);
    if (this.path_ && points) this.view_?.mark(points, place ?? pointOf(this.path_, points[1]));
  }

  /** Moves a place to the middle of the picture. */
  lookAt(place: Vec3): void {
    this.host.picture.viewer?.rig.lookAt(new Vector3(...place), performance.now());
  }

  /** Marks where the tool is at a time of the program. Returns the line; null: there is no path. */
  markTime(timeS: number): number | null {
    const place = this.path_ && placeAt(this.path_, timeS);
    if (!this.path_ || !place) return null;
    this.view_?.mark([place.point, place.point], place.tip);
    return this.path_.lines[place.point]!;
  }

  /** The feed along the path; null: there is no path. */
  get feeds(): FeedCurve | null {
    if (this.path_) this.feeds_ ??= feedCurveOf(this.path_);
    return this.feeds_;
  }

  private get isShown_(): boolean {
    return this.isOpen_ && this.shown_.checked && this.path_ !== null;
  }

  private draw_(): void {
    const { viewer } = this.host.picture;
    if (viewer) this.view_ ??= new PathView(viewer, this.host.overlay);
    this.view_?.show(this.isShown_ ? this.path_ : null);
    const error = this.path_?.errorMm ?? 0;
    setText(this.note_, error > 0 ? t('accurate to {0}', lengthText(error, 'mm')) : '');
  }

  private press_(x: number, y: number): void {
    const { viewer } = this.host.picture;
    const { path_: path } = this;
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
