// SPDX-License-Identifier: Apache-2.0
// The page without a server: takes files, has them carved in a worker, shows the block.

import { batch, signal } from '@preact/signals';
import { t } from '../strings';
import { mark } from '../model/marks';
import { SessionModel } from '../model/session';
import type { Action } from '../ui/actions';
import { eachFrame } from '../ui/frames';
import { Help, helpAction } from '../ui/help';
import { InspectPart } from '../ui/inspect/part';
import { listenToKeys } from '../ui/keyboard';
import { OneOpen } from '../ui/one_open';
import { Picture } from '../ui/picture';
import { TextState } from '../ui/programs/text_state';
import { Shell } from '../ui/shell';
import { Transport } from '../ui/timeline/transport';
import { cameraKeys, keyActions, viewActions } from '../ui/view_actions';
import type { CameraRig } from '../view/camera_rig';
import type { ToolInfo } from '../wire/types';
import { asWelcome } from './as_welcome';
import { keptStrokes } from './autosave';
import { CarvingWorker } from './carving_worker';
import { downloadModel } from './download';
import { downloadAction, DownloadDialog } from './download_dialog';
import { EXAMPLE_TOOLS, exampleBlock, exampleProgram } from './example';
import { FilesInput } from './files_input';
import { placeOfError } from './given_files';
import { LocalHand } from './hand';
import { LocalPath } from './local_path';
import type { FromWorker } from './messages';
import type { About, GivenFile, GivenFiles } from './program_block';
import { readGiven } from './read_given';
import type { ReadGiven } from './read_given';
import type { SideActions } from './side_panel';
import { ShownTiles } from './shown_tiles';
import { LocalState } from './state';
import { programAs, ToolTrack } from './tool_track';
import { LocalView } from './view';

export class LocalPage {
  readonly model = new SessionModel();
  private readonly state_ = new LocalState();
  private readonly shell_: Shell;
  private readonly picture_: Picture;
  private readonly input_ = new FilesInput((files) => this.take_(files));
  private readonly worker_ = new CarvingWorker((message) => this.heard_(message));
  private readonly tool_ = new ToolTrack(this.model);
  private readonly text_ = new TextState();
  private readonly transport_ = new Transport({
    step: (steps) => {
      const { about, progress } = this.state_;
      const end = about.peek()?.motions ?? 0;
      this.seek_(Math.max(0, Math.min(end, (progress.peek()?.carved ?? 0) + steps)));
    },
    play: (rate) => this.play_(rate),
  });
  private readonly path_: LocalPath;
  private readonly isHelpOpen_ = signal(false);
  private readonly inspect_: InspectPart;
  private readonly hand_: LocalHand;
  private carvesThen_ = false; // by hand, as soon as the block is displayed
  private isRestoring_ = false; // the strokes that the browser has kept
  private read_: ReadGiven | null = null;
  private problem_ = '';
  private readonly tiles_: ShownTiles;
  private readonly isDownloadOpen_ = signal(false);

  constructor(app: HTMLElement) {
    const shell = new Shell(app);
    this.shell_ = shell;
    this.picture_ = new Picture(shell.canvas, shell.overlay, this.model, false);
    this.tiles_ = new ShownTiles(this.picture_);
    shell.resized = (viewport) => this.picture_.resize(viewport);
    this.path_ = new LocalPath(this.picture_, shell, (line) => this.markLine_(line));
    const host = {
      ...{ model: this.model, picture: this.picture_, shell },
      ...{ canvas: shell.canvas, overlay: shell.overlay, oneOpen: new OneOpen() },
    };
    this.inspect_ = new InspectPart({ ...host, session: null });
    this.hand_ = new LocalHand({
      ...host,
      post: (message) => this.worker_.post(message),
      whyNot: () =>
        this.state_.about.value ? '' : t('There is no block yet. Choose files first.'),
      file: () => this.state_.files.peek().journal?.bytes ?? null,
      say: (text) => this.say_(text),
      begins: () => (this.state_.wish.value = null),
      frame: (nowMs) => this.frame_(nowMs),
    });
    this.show_();
    shell.layoutChanged();
  }

  private show_(): void {
    const { shell_: shell, picture_: picture, state_: state } = this;
    const [fit, ...sides] = viewActions(picture);
    const { carve } = this.hand_;
    const help = helpAction(this.isHelpOpen_);
    const actions = this.sideActions_();
    const main = [this.hand_.action, downloadAction(state, this.isDownloadOpen_)];
    const buttons = [fit!, this.inspect_.action, ...sides, help, carve.vr.action];
    this.listen_([...main, ...buttons, ...keyActions(picture)]);
    shell.show(
      carve.marks(),
      <LocalView
        shell={shell}
        state={state}
        main={main}
        buttons={buttons}
        panel={{
          ...{ shell, state, picture, text: this.text_, transport: this.transport_ },
          path: this.path_.shown,
          participants: this.model.participants,
          capMouse: {
            rig: () => this.rig_,
            isBusy: () => this.hand_.hasTool,
            say: (text) => this.say_(text),
          },
          actions,
        }}
      >
        {this.input_.view()}
        <Help isOpen={this.isHelpOpen_} />
        <DownloadDialog state={state} isOpen={this.isDownloadOpen_} actions={actions} />
        {this.inspect_.view()}
        {carve.bar()}
      </LocalView>,
    );
  }

  private sideActions_(): SideActions {
    return {
      choose: () => this.input_.choose(),
      example: () => this.take_([exampleProgram()]),
      newBlock: (tools) => {
        if (this.hand_.mayGo()) this.openStarter_(tools);
      },
      remove: (kind) => {
        if (!this.hand_.mayGo()) return;
        const { files } = this.state_;
        const others = kind === 'program' ? [] : files.peek().others;
        files.value = { ...files.peek(), [kind]: null, others };
        this.begin_();
      },
      stop: () => this.stop_(),
      seek: (motion) => this.seek_(motion),
      takeHome: (format) => this.worker_.post({ type: 'model', format }),
      save: () => this.hand_.save(),
      linePressed: (line) => {
        this.markLine_(line);
        this.path_.markLine(line);
      },
    };
  }

  start(): void {
    eachFrame(this.picture_, (nowMs) => this.frame_(nowMs));
    void this.openFirst_();
  }

  /** Opens the strokes that the browser has kept, or else a block, and has them carved by hand. */
  private async openFirst_(): Promise<void> {
    const kept = await keptStrokes().catch((problem: unknown) => {
      console.warn(problem); // the browser stores nothing
      return null;
    });
    if (this.state_.status.peek() !== 'empty') return; // the user has given files meanwhile
    if (!kept) {
      this.openStarter_(EXAMPLE_TOOLS);
      return;
    }
    this.take_([kept]);
    this.isRestoring_ = this.carvesThen_ = true;
  }

  private openStarter_(tools: readonly ToolInfo[]): void {
    this.state_.giveStarter(exampleBlock(tools));
    this.begin_();
    this.carvesThen_ = true;
  }

  private frame_(nowMs: number): void {
    this.tiles_.show();
    this.picture_.tick(nowMs);
    if (!this.carvesThen_ || this.state_.status.peek() !== 'rest' || !this.rig_) return;
    this.carvesThen_ = false;
    if (!this.hand_.isActive) this.hand_.toggle();
  }

  /** The page's state for tests (hook.ts). */
  get facts() {
    const { status, hash, about, progress } = this.state_;
    return {
      ...{ status: status.peek(), problem: this.problem_, hash: hash.peek() },
      ...{ carved: progress.peek()?.carved ?? 0, isBusy: this.hand_.isBusy },
      motions: about.peek()?.motions ?? 0,
      removedMm3: progress.peek()?.removed_mm3 ?? 0,
      waiting: this.tiles_.waiting,
      viewer: this.picture_.viewer,
    };
  }

  private get rig_(): CameraRig | undefined {
    return this.picture_.viewer?.rig;
  }

  private listen_(actions: readonly Action[]): void {
    const { canvas, main, isDropping } = this.shell_;
    listenToKeys(cameraKeys(this.picture_), actions);
    window.addEventListener('resize', this.shell_.layoutChanged);
    canvas.addEventListener('dblclick', (event) =>
      this.picture_.viewer?.lookAtPixel(event.offsetX, event.offsetY),
    );
    this.input_.takeDropsOn(main, isDropping);
  }

  private say_(text: string): void {
    this.state_.error.value = text;
  }

  private markLine_(line: number): void {
    this.text_.markLine({ line, word: '', isPlace: true });
  }

  private take_(files: readonly GivenFile[]): void {
    if (!this.hand_.mayGo()) return;
    this.state_.give(files);
    this.begin_();
  }

  /** Has the files carved from the start. */
  private begin_(): void {
    const { state_: state, path_: path } = this;
    this.worker_.end();
    this.hand_.reset([]);
    this.carvesThen_ = this.isRestoring_ = false;
    this.read_ = null;
    this.problem_ = '';
    path.hide();
    batch(() => {
      state.begin();
      this.transport_.rate.value = 0;
      this.text_.show(state.text.peek() ?? '');
      this.text_.follow(true);
    });
    if (state.status.peek() === 'empty') this.openStarter_(EXAMPLE_TOOLS);
    else void this.open_(state.files.peek());
  }

  private async open_(files: GivenFiles): Promise<void> {
    const isCurrent = (): boolean => this.state_.files.peek() === files;
    try {
      const read = await readGiven(files);
      if (!isCurrent()) return; // others were given meanwhile
      this.read_ = read;
      this.worker_.open(read.first);
    } catch (problem) {
      if (isCurrent()) this.reject_((problem as Error).message, true);
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
        void downloadModel(
          this.state_.about.peek()?.name ?? 'block',
          message.format,
          message.bytes,
        );
        return;
      case 'handed':
        this.state_.about.value = message.about;
        this.path_.hide();
        this.hand_.heard(message);
        this.state_.hasJournal.value = true;
        return;
      case 'felt':
      case 'changed':
        this.state_.hash.value = null; // that of the block before
        if (message.type === 'felt') this.state_.extend(message.progress.carved);
        this.hand_.heard(message);
        return;
      case 'saved':
        this.hand_.heard(message);
        return;
      case 'rejected':
        this.reject_(message.reason, this.state_.about.peek() === null);
        return;
      case 'unwritten':
        this.say_(message.reason);
        return;
      case 'failed':
        this.worker_.end();
        this.reject_(t('Carving stopped: {0}', message.reason), true);
    }
  }

  private opened_(about: About, path: unknown): void {
    this.state_.about.value = about;
    const welcome = asWelcome(about);
    this.clearPicture_();
    this.model.apply(welcome);
    this.model.tiles.finishSnapshot();
    this.model.setStatus('connected', '');
    const people = this.read_?.participants ?? [];
    const isProgram = about.kernel_version === undefined && about.motions > 0;
    this.model.participants.setList(people);
    this.hand_.reset(isProgram ? [programAs(about.name, 0)] : people);
    if (this.isRestoring_) this.hand_.restored();
    this.picture_.welcome(welcome);
    mark('welcome');
    document.title = `${about.name} · Kerf`;
    this.state_.status.value = 'carving';
    if (path !== null && about.motions > 0) void this.showPath_(about, path);
  }

  private async showPath_(about: About, path: unknown): Promise<void> {
    await this.path_.show(path, () => this.state_.about.peek() === about);
    this.showReached_();
  }

  private showReached_(): void {
    const progress = this.state_.progress.peek();
    const about = this.state_.about.peek();
    if (progress && about) this.path_.reach(progress, about);
  }

  private carved_(message: FromWorker & { type: 'carved' }): void {
    const { progress, tiles, hash, rate, carvingMs } = message;
    const { state_: state } = this;
    state.extend(progress.carved);
    const about = state.about.peek();
    if (!about) return;
    this.tiles_.add(tiles);
    batch(() => {
      state.progress.value = progress;
      state.hash.value = hash;
      state.carvingMs.value = carvingMs;
      state.triangles.value = this.tiles_.triangles;
      state.stored.value = this.read_?.compare(progress.carved, hash, about) ?? '';
      state.status.value = hash !== null && rate === 0 ? 'rest' : 'carving';
      this.transport_.rate.value = rate;
      this.text_.setLive(progress.carved < about.motions ? progress.line : 0);
    });
    if (progress.tools) this.tool_.showAll(progress.tools);
    else this.tool_.show(progress, progress.carved < about.motions);
    this.showReached_();
  }

  /** @param hasEnded there is no block */
  private reject_(reason: string, hasEnded: boolean): void {
    const { program } = this.state_.files.peek();
    this.problem_ = reason;
    this.say_(reason);
    const place = program && placeOfError(program.name, reason);
    if (place) this.text_.markLine(place);
    if (!hasEnded) return;
    this.state_.status.value = 'failed';
    this.clearPicture_();
  }

  private stop_(): void {
    const { about, progress, wish } = this.state_;
    if (about.peek()) {
      wish.value = progress.peek()?.carved ?? 0;
      this.worker_.post({ type: 'stop' });
      return;
    }
    this.worker_.end();
    this.reject_(t('Stopped before the files were read.'), true);
  }

  private seek_(motion: number): void {
    this.hand_.leave();
    this.state_.wish.value = motion;
    this.worker_.post({ type: 'seek', motion });
  }

  private play_(rate: number): void {
    const { wish } = this.state_;
    if (rate > 0) this.hand_.leave();
    // From the place to which it was sent; else from where it is.
    if (rate === 0 || wish.peek() === null) this.worker_.post({ type: 'stop' });
    if (rate > 0) this.worker_.post({ type: 'play', rate });
    wish.value = null;
  }

  private clearPicture_(): void {
    this.tiles_.clear();
    this.tool_.clear();
  }
}
