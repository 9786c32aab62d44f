// SPDX-License-Identifier: Apache-2.0
// The past of a session, replayed in this browser: answers the seeks of the timeline in place of the
// server, from a journal that caches hold. Where it cannot, the server does.

import { journalOrigin, journalRecords, replayState } from '../link/replay';
import { CarvingWorker } from '../local/carving_worker';
import type { FromWorker } from '../local/messages';
import type { TileTriangles } from '../kernel/kernel';
import type { SessionModel } from '../model/session';
import { tileKey } from '../model/tiles';
import type { Picture } from '../ui/picture';
import type { Seek, StateMessage } from '../wire/types';

/** Longer journals are left to the server: their first look back would take a minute here. */
export const RECORDS_MAX = 500_000;
/** Newer than all samples of the page's own copy. */
const NEWEST = 1n << 63n;

export interface PastHost {
  session: string;
  model: SessionModel;
  picture: Picture;
  /** Asks the server. */
  seek: (seek: Seek) => void;
  /** Whether tiles of the page's copy are displayed, so that there is no place for the past. */
  isCarving: () => boolean;
}

type Kind = 'unknown' | 'loading' | 'here' | 'server';

export class LocalPast {
  private kind_: Kind = 'unknown';
  private readonly worker_: CarvingWorker;
  private journal_ = '';
  private records_ = 0; // that the worker has
  private wish_: Seek | null = null; // null: the present
  private isShown_ = false;
  private live_: StateMessage | null = null; // newest, while the past is shown
  private readonly tiles_ = new Map<number, TileTriangles>();
  private waiting_ = new Map<number, TileTriangles>(); // not displayed yet

  constructor(
    private readonly host: PastHost,
    makeWorker = (heard: (message: FromWorker) => void) => new CarvingWorker(heard),
  ) {
    this.worker_ = makeWorker((message) => this.heard_(message));
  }

  /** Whether the picture is this past's: messages of the server on the present are kept from it. */
  get isShown(): boolean {
    return this.isShown_;
  }

  /** Keeps a state of the present for the return to it. */
  keep(state: StateMessage): void {
    this.live_ = state;
  }

  /** The server has welcomed the page again: its tiles are those of the present. */
  welcomed(): void {
    this.isShown_ = false;
    this.wish_ = null;
    this.worker_.post({ type: 'stop' });
  }

  seek(seek: Seek): void {
    if (seek.at === 'live' && (this.isShown_ || this.kind_ === 'loading')) {
      this.endPast_();
      return;
    }
    const isServers = this.kind_ === 'server' || this.host.isCarving();
    if (isServers && !this.isShown_) {
      this.host.seek(seek);
      return;
    }
    this.wish_ = { ...this.wish_, ...seek, rate: seek.rate ?? 0 };
    if (this.kind_ === 'unknown') void this.load_();
    else if (this.kind_ === 'here') void this.go_(seek);
  }

  private endPast_(): void {
    this.wish_ = null;
    this.worker_.post({ type: 'stop' });
    const { model, picture } = this.host;
    if (!this.isShown_) return;
    this.isShown_ = false;
    picture.viewer?.local.close();
    model.participants.forgetPoses();
    if (this.live_) model.apply(this.live_);
    picture.viewer?.touchAll();
  }

  private async load_(): Promise<void> {
    this.kind_ = 'loading';
    const { session } = this.host;
    try {
      const state = await replayState(session);
      if (state.record > RECORDS_MAX) throw new Error(`${state.record} records`);
      this.journal_ = state.journal;
      const origin = await journalOrigin(session, state.journal);
      const spans = await journalRecords(session, state.journal, 0, state.record);
      this.records_ = state.record;
      const to = typeof this.wish_?.at === 'number' ? this.wish_.at : state.record;
      this.worker_.open({ type: 'journal', journal: { origin, spans }, to, isSilent: false });
    } catch (problem) {
      this.leaveToServer_((problem as Error).message);
    }
  }

  /** From now on the server shows the past. */
  private leaveToServer_(reason: string): void {
    console.warn(`The server shows the past, because the page cannot: ${reason}`);
    this.kind_ = 'server';
    this.worker_.end();
    const wish = this.wish_;
    this.endPast_();
    if (wish) this.host.seek(wish);
  }

  private async go_({ at, rate = 0 }: Seek): Promise<void> {
    try {
      if (typeof at === 'number' && at > this.records_) await this.extend_();
    } catch (problem) {
      this.leaveToServer_((problem as Error).message);
      return;
    }
    if (typeof at === 'number') {
      if (this.wish_?.at !== at) return; // another wish meanwhile
      this.worker_.post({ type: 'seek', motion: at });
    }
    if (rate > 0) this.worker_.post({ type: 'play', rate });
    else if (typeof at !== 'number') this.worker_.post({ type: 'stop' });
    this.show_();
  }

  private async extend_(): Promise<void> {
    const { session } = this.host;
    const { record } = await replayState(session);
    for (const span of await journalRecords(session, this.journal_, this.records_, record))
      this.worker_.post({ type: 'records', span });
    this.records_ = Math.max(this.records_, record);
  }

  private heard_(message: FromWorker): void {
    switch (message.type) {
      case 'opened':
        this.kind_ = 'here';
        if (this.wish_ && (this.wish_.rate ?? 0) > 0)
          this.worker_.post({ type: 'play', rate: this.wish_.rate! });
        return;
      case 'carved':
        this.carved_(message);
        return;
      case 'rejected':
      case 'failed':
        this.leaveToServer_(message.reason);
        return;
      case 'model':
      case 'unwritten':
    }
  }

  private carved_({ progress, tiles, hash, rate }: FromWorker & { type: 'carved' }): void {
    for (const tile of tiles) {
      this.tiles_.set(tileKey(tile.x, tile.y), tile);
      this.waiting_.set(tileKey(tile.x, tile.y), tile);
    }
    if (!this.wish_) return; // the present is shown
    this.show_();
    if (!this.isShown_) return; // no tile yet: the state would be one that is not displayed
    const { model } = this.host;
    const isAtEnd = progress.carved === this.records_;
    const played = rate > 0 ? rate : isAtEnd ? (this.wish_.rate ?? 0) : 0;
    model.apply({
      type: 'state',
      motions: progress.carved,
      removed_volume_mm3: progress.removed_mm3,
      state_hash: hash ?? '–',
      settled: hash !== null,
      at: { record: progress.carved, time_ms: progress.time_ms ?? 0, rate: played },
    });
    // Where a tool is in the past is known while the block plays, not at a place that was sought.
    const tools = rate > 0 ? (progress.tools ?? []) : [];
    const unfelt = tools.map((tool) => ({ ...tool, felt_share: 0 }));
    model.participants.applyTools(unfelt, performance.now());
  }

  /** Displays the tiles, over those of the present. */
  private show_(): void {
    const { model, picture } = this.host;
    const { viewer } = picture;
    if (!viewer || !model.welcome || this.tiles_.size === 0) return;
    if (!this.isShown_) {
      this.isShown_ = true;
      this.live_ = model.state?.at ? null : model.state;
      model.participants.forgetPoses();
      this.waiting_ = new Map(this.tiles_);
    }
    viewer.local.open(); // also if someone who has left closes it
    viewer.local.cover([...this.waiting_.values()], NEWEST, model.welcome.grid.origin_mm);
    viewer.touchAll();
    this.waiting_.clear();
  }
}
