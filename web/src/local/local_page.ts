// SPDX-License-Identifier: Apache-2.0
// The page without a server: takes files, has them carved in a worker, shows the block.

import { t } from '../strings';
import { mark, marks } from '../marks';
import type { TileTriangles } from '../kernel/kernel';
import { pathOfAnswer } from '../model/program_path';
import { SessionModel } from '../model/session';
import { tileKey } from '../model/tiles';
import { h, setText } from '../ui/dom';
import { insetsOf } from '../ui/insets';
import { mountInspect } from '../ui/inspect/mount';
import { listenToKeys } from '../ui/keyboard';
import { OneOpen } from '../ui/one_open';
import { Picture } from '../ui/picture';
import type { PathControl } from '../ui/programs/path_control';
import type { CameraRig } from '../view/camera_rig';
import { asWelcome } from './as_welcome';
import { titleBar, viewToolbar } from './bars';
import { CarvingWorker } from './carving_worker';
import { download } from './download';
import { exampleProgram } from './example';
import { NO_FILES, placeOfError, withFiles } from './given_files';
import type { FromWorker } from './messages';
import type { About, GivenFile, GivenFiles, Progress } from './program_block';
import { readGiven } from './read_given';
import type { ReadGiven } from './read_given';
import { SidePanel } from './side_panel';
import type { Status } from './side_panel';
import { startCard } from './start_card';
import { ToolTrack } from './tool_track';

/** Of the block that is displayed: the page has no participants whose samples would be newer. */
const NEWEST = 1n;

const NOTHING = (): void => undefined;

export class LocalPage {
  readonly model = new SessionModel();
  private readonly canvas_ = h('canvas', {
    class: 'canvas',
    tabindex: '0',
    role: 'img',
    'aria-label': t('The block and the tools, in 3D'),
  });
  private readonly overlay_ = h('div', { class: 'overlay', 'aria-hidden': 'true' });
  private readonly title_ = h('h1', { class: 'session-name' }, t('Without a server'));
  private readonly file_ = h('input', {
    type: 'file',
    multiple: '',
    hidden: '',
    'aria-label': t('Files'),
  });
  private readonly main_: HTMLElement;
  private readonly start_: HTMLElement;
  private readonly toolbar_: HTMLElement;
  private readonly picture_: Picture;
  private readonly panel_: SidePanel;
  private readonly worker_ = new CarvingWorker((message) => this.heard_(message));
  private readonly tool_ = new ToolTrack(this.model);
  private path_: PathControl | null = null;
  private files_ = NO_FILES;
  private read_: ReadGiven | null = null;
  private status_: Status = 'empty';
  private about_: About | null = null;
  private progress_: Progress | null = null;
  private hash_: string | null = null;
  private problem_ = '';
  /** Where the user has moved the scrub bar; null: the program goes on to its end. */
  private wish_: number | null = null;
  private readonly triangles_ = new Map<number, number>();
  private readonly waiting_ = new Map<number, TileTriangles>(); // for the view to open

  constructor(private readonly app: HTMLElement) {
    this.picture_ = new Picture(this.canvas_, this.overlay_, this.model, false);
    this.panel_ = new SidePanel({
      choose: () => this.file_.click(),
      remove: (what) => {
        this.files_ = { ...this.files_, [what]: null };
        if (what === 'program') this.files_.others = [];
        this.begin_();
      },
      stop: () => this.stop_(),
      seek: (motion) => this.seek_(motion),
      play: (rate) => this.play_(rate),
      takeHome: (format) => this.worker_.post({ type: 'model', format }),
      linePressed: (line) => {
        this.panel_.markLine(line);
        this.path_?.markLine(line);
      },
      materialChosen: (preset) => this.picture_.setMaterial(preset),
      layoutChanged: () => this.resize_(),
    });
    this.start_ = startCard({
      choose: () => this.file_.click(),
      example: () => this.take_([exampleProgram()]),
    });
    this.toolbar_ = viewToolbar(() => this.rig_);
    this.main_ = h(
      'main',
      { class: 'viewer' },
      this.canvas_,
      this.overlay_,
      titleBar(this.title_),
      this.toolbar_,
      this.start_,
      this.panel_.element,
      this.file_,
    );
    app.replaceChildren(this.main_);
    const toggleInspect = mountInspect({
      model: this.model,
      session: null,
      picture: this.picture_,
      canvas: this.canvas_,
      overlay: this.overlay_,
      toolbar: this.toolbar_,
      oneOpen: new OneOpen(),
      layoutChanged: () => this.resize_(),
    });
    this.listen_(toggleInspect);
    this.begin_();
    this.resize_();
    this.installHook_();
  }

  start(): void {
    const frame = (nowMs: number): void => {
      this.showWaiting_();
      this.picture_.tick(nowMs);
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  private get rig_(): CameraRig | undefined {
    return this.picture_.viewer?.rig;
  }

  private listen_(toggleInspect: () => void): void {
    listenToKeys({
      preset: (preset) => this.rig_?.preset(preset, performance.now()),
      fit: () => this.rig_?.fit(performance.now()),
      orbit: (around, up) => this.rig_?.orbit(around, up),
      pan: (right, up) => this.rig_?.pan(right, up),
      zoom: (factor) => this.rig_?.zoom(factor),
      followNext: NOTHING,
      followNone: NOTHING,
      toggleArrows: NOTHING,
      toggleGrid: () => this.picture_.viewer?.toggleGrid(),
      toggleSound: NOTHING,
      toggleTimeline: NOTHING,
      toggleInspect,
      toggleParallel: () => {
        const { viewer } = this.picture_;
        if (viewer) viewer.parallel = !viewer.rig.parallel;
      },
      toggleCarve: NOTHING,
      undo: NOTHING,
      redo: NOTHING,
      help: NOTHING,
    });
    window.addEventListener('resize', () => this.resize_());
    this.canvas_.addEventListener('dblclick', (event) =>
      this.picture_.viewer?.lookAtPixel(event.offsetX, event.offsetY),
    );
    this.file_.addEventListener('change', () => {
      void this.takeFiles_([...(this.file_.files ?? [])]);
      this.file_.value = ''; // the same file may be chosen again
    });
    const { main_: main } = this;
    main.addEventListener('dragover', (event) => {
      event.preventDefault();
      main.classList.add('dropping');
    });
    for (const end of ['dragleave', 'drop'])
      main.addEventListener(end, () => main.classList.remove('dropping'));
    main.addEventListener('drop', (event) => {
      event.preventDefault();
      void this.takeFiles_([...(event.dataTransfer?.files ?? [])]);
    });
  }

  private async takeFiles_(files: readonly File[]): Promise<void> {
    const given = files.map(async (file) => ({
      name: file.name,
      bytes: new Uint8Array(await file.arrayBuffer()),
    }));
    if (given.length > 0) this.take_(await Promise.all(given));
  }

  private take_(files: readonly GivenFile[]): void {
    this.files_ = withFiles(this.files_, files);
    this.begin_();
  }

  /** Has the files carved from the start. */
  private begin_(): void {
    const { program, scene, stock, journal } = this.files_;
    this.worker_.end();
    this.read_ = null;
    this.about_ = null;
    this.progress_ = null;
    this.hash_ = null;
    this.problem_ = '';
    this.wish_ = null;
    this.path_?.show(null);
    this.panel_.setFiles(this.files_, program ? new TextDecoder().decode(program.bytes) : null);
    const first = journal ?? program ?? scene ?? stock;
    const isEmpty = first === null;
    setText(this.title_, first?.name ?? t('Without a server'));
    this.setStatus_(isEmpty ? 'empty' : 'reading');
    if (isEmpty) this.clearPicture_();
    else void this.open_(this.files_);
  }

  private async open_(files: GivenFiles): Promise<void> {
    try {
      const read = await readGiven(files);
      if (this.files_ !== files) return; // others were given meanwhile
      this.read_ = read;
      this.worker_.open(read.first);
    } catch (problem) {
      if (this.files_ === files) this.reject_((problem as Error).message, true);
    }
  }

  private heard_(message: FromWorker): void {
    switch (message.type) {
      case 'opened':
        this.opened_(message.about, message.path);
        return;
      case 'carved':
        this.carved_(message);
        return;
      case 'model':
        download(`${this.about_?.name ?? 'block'}.${message.format}`, message.bytes);
        return;
      case 'rejected':
        this.reject_(message.reason, this.about_ === null);
        return;
      case 'unwritten':
        this.panel_.showError(message.reason, null);
        return;
      case 'failed':
        this.worker_.end();
        this.reject_(t('Carving has ended: {0}', message.reason), true);
    }
  }

  private opened_(about: About, path: unknown): void {
    this.about_ = about;
    const welcome = asWelcome(about);
    this.clearPicture_();
    this.model.apply(welcome);
    this.model.tiles.finishSnapshot();
    this.model.setStatus('connected', '');
    this.model.participants.setList(this.read_?.participants ?? []);
    this.picture_.welcome(welcome);
    mark('welcome');
    setText(this.title_, about.name);
    document.title = `${about.name} · Kerf`;
    this.panel_.setAbout(about);
    this.setStatus_('carving');
    if (path !== null && about.motions > 0) void this.showPath_(about, path);
  }

  /** The code of paths needs that of the view, which comes later than the panel's. */
  private async showPath_(about: About, path: unknown): Promise<void> {
    const { PathControl } = await import('../ui/programs/path_control');
    while (this.picture_.viewer === null && this.picture_.problem === '')
      await new Promise((resolve) => setTimeout(resolve, 50));
    if (this.about_ !== about) return;
    const host = { picture: this.picture_, canvas: this.canvas_, overlay: this.overlay_ };
    if (!this.path_) {
      this.path_ = new PathControl(host, () => Promise.reject(new Error('no path')));
      this.path_.pressed = (line) => this.panel_.markLine(line);
      this.panel_.path.append(this.path_.element);
      this.path_.setOpen(true);
    }
    this.path_.show(pathOfAnswer(path));
    this.showReached_();
  }

  private showReached_(): void {
    const { progress_: progress, about_: about } = this;
    if (!progress || !about) return;
    this.path_?.reach(progress.carved, about.motions, progress.line);
  }

  private carved_({
    progress,
    tiles,
    hash,
    rate,
    carvingMs,
  }: FromWorker & { type: 'carved' }): void {
    const { about_: about } = this;
    if (!about) return;
    this.progress_ = progress;
    this.hash_ = hash;
    for (const tile of tiles) {
      const key = tileKey(tile.x, tile.y);
      this.waiting_.set(key, tile);
      this.triangles_.set(key, tile.index.length / 3);
    }
    const triangles = [...this.triangles_.values()].reduce((sum, one) => sum + one, 0);
    this.panel_.setProgress(progress, triangles, this.wish_ === null);
    this.panel_.setHash(hash, carvingMs);
    this.panel_.setStored(this.read_?.compare(progress.carved, hash, about) ?? '');
    this.panel_.setRate(rate);
    if (progress.tools) this.tool_.showAll(progress.tools);
    else this.tool_.show(progress, progress.carved < about.motions);
    this.showReached_();
    if (hash !== null && rate === 0) this.setStatus_('rest');
    else this.setStatus_('carving');
  }

  /** @param hasEnded there is no block */
  private reject_(reason: string, hasEnded: boolean): void {
    const { program } = this.files_;
    this.problem_ = reason;
    const place = program && placeOfError(program.name, reason);
    this.panel_.showError(reason, place);
    if (hasEnded) this.setStatus_('failed');
  }

  private stop_(): void {
    if (this.about_) {
      this.wish_ = this.progress_?.carved ?? 0;
      this.worker_.post({ type: 'stop' });
      return;
    }
    this.worker_.end();
    this.reject_(t('Stopped while the files were read.'), true);
  }

  private seek_(motion: number): void {
    this.wish_ = motion;
    this.worker_.post({ type: 'seek', motion });
  }

  private play_(rate: number): void {
    // From the place to which it was sent; else from where it is.
    if (rate === 0 || this.wish_ === null) this.worker_.post({ type: 'stop' });
    if (rate > 0) this.worker_.post({ type: 'play', rate });
    this.wish_ = null;
  }

  private setStatus_(status: Status): void {
    this.status_ = status;
    this.panel_.setStatus(status);
    this.start_.hidden = status !== 'empty';
  }

  private clearPicture_(): void {
    this.waiting_.clear();
    this.triangles_.clear();
    this.tool_.clear();
    this.picture_.viewer?.local.clear();
    this.picture_.viewer?.touchAll();
  }

  private showWaiting_(): void {
    const { viewer } = this.picture_;
    if (!viewer || this.waiting_.size === 0) return;
    viewer.local.open();
    viewer.applyCopy([...this.waiting_.values()], NEWEST);
    this.waiting_.clear();
  }

  private resize_(): void {
    const width = Math.max(1, this.app.clientWidth);
    const height = Math.max(1, this.app.clientHeight);
    this.picture_.resize({ width, height, insets: insetsOf(this.app, width, height) });
  }

  /** window.kerf, for tests: state(), surface() and marks, as in hook.ts. */
  private installHook_(): void {
    const state = () => ({
      status: this.status_,
      problem: this.problem_,
      hash: this.hash_,
      carved: this.progress_?.carved ?? 0,
      motions: this.about_?.motions ?? 0,
      hasPicture: this.picture_.viewer !== null,
      copyTiles: this.picture_.viewer?.local.size ?? 0,
      waiting: this.waiting_.size,
    });
    const surface = () => this.picture_.viewer?.surface() ?? [];
    Object.defineProperty(window, 'kerf', {
      value: Object.freeze({ state, surface, marks }),
      writable: false,
    });
  }
}
