// SPDX-License-Identifier: Apache-2.0
// The page without a server: takes files, has them carved in a worker, shows the block.

import { t } from '../strings';
import { mark } from '../model/marks';
import type { TileTriangles } from '../kernel/kernel';
import { pathOfAnswer } from '../model/program_path';
import { SessionModel } from '../model/session';
import { tileKey } from '../model/tiles';
import { h, setText } from '../ui/dom';
import { eachFrame } from '../ui/frames';
import { insetsOf } from '../ui/insets';
import { mountInspect } from '../ui/inspect/mount';
import { OneOpen } from '../ui/one_open';
import { Picture } from '../ui/picture';
import type { PathControl } from '../ui/programs/path_control';
import type { CameraRig } from '../view/camera_rig';
import { asWelcome } from './as_welcome';
import { titleBar, viewToolbar } from './bars';
import { CarvingWorker } from './carving_worker';
import { downloadModel } from './download';
import { exampleBlock, exampleProgram } from './example';
import { FilesInput } from './files_input';
import { NO_FILES, placeOfError, withFiles } from './given_files';
import { LocalHand } from './hand';
import type { FromWorker } from './messages';
import { listenToLocalKeys } from './keys';
import type { About, GivenFile, GivenFiles, Progress } from './program_block';
import { readGiven } from './read_given';
import type { ReadGiven } from './read_given';
import { SidePanel } from './side_panel';
import type { Status } from './side_panel';
import { startCard } from './start_card';
import { programAs, ToolTrack } from './tool_track';

/** Of the block that is displayed: the page has no participants whose samples would be newer. */
const NEWEST = 1n;

export class LocalPage {
  readonly model = new SessionModel();
  private readonly canvas_ = h('canvas', {
    class: 'canvas',
    tabindex: '0',
    role: 'img',
    'aria-label': t('3D view of the block and the tools'),
  });
  private readonly overlay_ = h('div', { class: 'overlay', 'aria-hidden': 'true' });
  private readonly title_ = h('h1', { class: 'session-name' }, t('Without a server'));
  private readonly input_ = new FilesInput((files) => this.take_(files));
  private readonly main_: HTMLElement;
  private readonly start_: HTMLElement;
  private readonly toolbar_: HTMLElement;
  private readonly picture_: Picture;
  private readonly panel_: SidePanel;
  private readonly worker_ = new CarvingWorker((message) => this.heard_(message));
  private readonly tool_ = new ToolTrack(this.model);
  private readonly hand_: LocalHand;
  private carvesThen_ = false; // by hand, as soon as the block is displayed
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
    this.panel_ = this.makePanel_();
    this.start_ = startCard({
      choose: () => this.input_.choose(),
      example: () => this.take_([exampleProgram()]),
      goOn: (file) => this.take_([file]),
      carve: (tools) => {
        this.take_([exampleBlock(tools)]);
        this.carvesThen_ = true;
      },
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
      this.input_.element,
    );
    app.replaceChildren(this.main_);
    const around = {
      model: this.model,
      picture: this.picture_,
      canvas: this.canvas_,
      overlay: this.overlay_,
      toolbar: this.toolbar_,
      oneOpen: new OneOpen(),
      layoutChanged: () => this.resize_(),
    };
    const toggleInspect = mountInspect({ ...around, session: null });
    this.hand_ = new LocalHand({
      ...around,
      post: (message) => this.worker_.post(message),
      whyNot: () => (this.about_ ? '' : t('There is no block yet. Choose files first.')),
      file: () => this.files_.journal?.bytes ?? null,
      say: (text) => this.panel_.showError(text, null),
      begins: () => (this.wish_ = null),
      frame: (nowMs) => this.frame_(nowMs),
    });
    this.listen_(toggleInspect);
    this.begin_();
    this.resize_();
  }

  private makePanel_(): SidePanel {
    return new SidePanel({
      choose: () => this.input_.choose(),
      remove: (what) => {
        if (!this.hand_.mayGo()) return;
        this.files_ = { ...this.files_, [what]: null };
        if (what === 'program') this.files_.others = [];
        this.begin_();
      },
      stop: () => this.stop_(),
      seek: (motion) => this.seek_(motion),
      play: (rate) => this.play_(rate),
      takeHome: (format) => this.worker_.post({ type: 'model', format }),
      save: () => this.hand_.save(),
      linePressed: (line) => {
        this.panel_.markLine(line);
        this.path_?.markLine(line);
      },
      materialChosen: (preset) => this.picture_.setMaterial(preset),
      capMouse: {
        rig: () => this.rig_,
        isBusy: () => this.hand_.hasTool,
        say: (text) => this.panel_.showError(text, null),
      },
      layoutChanged: () => this.resize_(),
    });
  }

  start(): void {
    eachFrame(this.picture_, (nowMs) => this.frame_(nowMs));
  }

  private frame_(nowMs: number): void {
    this.showWaiting_();
    this.picture_.tick(nowMs);
    this.hand_.update();
    if (!this.carvesThen_ || this.status_ !== 'rest' || !this.rig_) return;
    this.carvesThen_ = false;
    this.hand_.toggle();
  }

  /** The page's state for tests (hook.ts). */
  get facts() {
    const { status_: status, problem_: problem, hash_: hash, progress_: progress } = this;
    return {
      ...{ status, problem, hash, carved: progress?.carved ?? 0, isBusy: this.hand_.isBusy },
      motions: this.about_?.motions ?? 0,
      removedMm3: progress?.removed_mm3 ?? 0,
      waiting: this.waiting_.size,
      viewer: this.picture_.viewer,
    };
  }

  private get rig_(): CameraRig | undefined {
    return this.picture_.viewer?.rig;
  }

  private listen_(toggleInspect: () => void): void {
    listenToLocalKeys(this.picture_, toggleInspect, () => this.hand_.toggle());
    window.addEventListener('resize', () => this.resize_());
    this.canvas_.addEventListener('dblclick', (event) =>
      this.picture_.viewer?.lookAtPixel(event.offsetX, event.offsetY),
    );
    this.input_.takeDropsOn(this.main_);
  }

  private take_(files: readonly GivenFile[]): void {
    if (!this.hand_.mayGo()) return;
    this.files_ = withFiles(this.files_, files);
    this.begin_();
  }

  /** Has the files carved from the start. */
  private begin_(): void {
    const { program, scene, stock, journal } = this.files_;
    this.worker_.end();
    this.hand_.reset([]);
    this.panel_.setJournal(false);
    this.carvesThen_ = false;
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
    if (!isEmpty) void this.open_(this.files_);
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
        void downloadModel(this.about_?.name ?? 'block', message.format, message.bytes);
        return;
      case 'handed':
        this.about_ = message.about;
        this.panel_.setAbout(message.about);
        this.path_?.show(null);
        this.hand_.heard(message);
        this.panel_.setJournal(true);
        return;
      case 'felt':
      case 'changed':
        this.hash_ = null; // that of the block before
        if (message.type === 'felt') this.moved_(message.progress.carved);
        this.hand_.heard(message);
        return;
      case 'saved':
        this.hand_.heard(message);
        return;
      case 'rejected':
        this.reject_(message.reason, this.about_ === null);
        return;
      case 'unwritten':
        this.panel_.showError(message.reason, null);
        return;
      case 'failed':
        this.worker_.end();
        this.reject_(t('Carving stopped: {0}', message.reason), true);
    }
  }

  private opened_(about: About, path: unknown): void {
    this.about_ = about;
    const welcome = asWelcome(about);
    this.clearPicture_();
    this.model.apply(welcome);
    this.model.tiles.finishSnapshot();
    this.model.setStatus('connected', '');
    const people = this.read_?.participants ?? [];
    const isProgram = about.kernel_version === undefined && about.motions > 0;
    this.model.participants.setList(people);
    this.hand_.reset(isProgram ? [programAs(about.name, 0)] : people);
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

  private carved_(message: FromWorker & { type: 'carved' }): void {
    const { progress, tiles, hash, rate, carvingMs } = message;
    this.moved_(progress.carved);
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

  /** A hand has added records to those that were read. */
  private moved_(motions: number): void {
    if (!this.about_ || motions <= this.about_.motions) return;
    this.about_ = { ...this.about_, motions };
    this.panel_.setAbout(this.about_);
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
    this.reject_(t('Stopped before the files were read.'), true);
  }

  private seek_(motion: number): void {
    this.hand_.leave();
    this.wish_ = motion;
    this.worker_.post({ type: 'seek', motion });
  }

  private play_(rate: number): void {
    if (rate > 0) this.hand_.leave();
    // From the place to which it was sent; else from where it is.
    if (rate === 0 || this.wish_ === null) this.worker_.post({ type: 'stop' });
    if (rate > 0) this.worker_.post({ type: 'play', rate });
    this.wish_ = null;
  }

  private setStatus_(status: Status): void {
    this.status_ = status;
    this.panel_.setStatus(status);
    this.start_.hidden = status !== 'empty';
    if (status === 'empty' || status === 'failed') this.clearPicture_();
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
}
