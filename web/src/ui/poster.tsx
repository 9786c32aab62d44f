// SPDX-License-Identifier: Apache-2.0
// A picture of the block made by the server, where the browser cannot draw it, or not yet.

import { signal, useComputed, useSignalEffect } from '@preact/signals';
import type { ReadonlySignal } from '@preact/signals';
import { useMemo } from 'preact/hooks';
import { t } from '../strings';
import { pictureUrl, PictureVersions } from '../link/picture_url';
import type { PictureWidth } from '../link/picture_url';
import { request } from '../link/request';
import type { SessionModel } from '../model/session';
import type { StateMessage } from '../wire/types';
import type { Picture } from './picture';

const RENEW_MS = 3000;
/**
 * Of the only picture of the block, and of one that stands there until the page has drawn its own:
 * the server mostly has that one, because the list of blocks shows it.
 */
const WIDTHS = { alone: 960, until: 480 } as const;

/** The newest picture from the server. */
class PosterSource {
  /** Empty until the first one has come. */
  readonly url = signal('');
  private askedMs_ = -Infinity;
  private readonly versions_ = new PictureVersions();

  constructor(private readonly session: string) {}

  /** Requests the picture of a state, unless it was requested a moment ago. */
  renew(state: StateMessage | null, width: PictureWidth, nowMs: number): void {
    if (nowMs - this.askedMs_ < RENEW_MS) return;
    this.askedMs_ = nowMs;
    const { motions = 0, removed_volume_mm3 = 0 } = state ?? {};
    const version = this.versions_.next(motions, removed_volume_mm3);
    if (version !== null) void this.fetch_(pictureUrl(this.session, version, width));
  }

  /** The page's policy permits pictures of its own server only. */
  private async fetch_(path: string): Promise<void> {
    const response = await request(path).catch(() => null);
    if (!response?.ok) return; // the last one stays
    const before = this.url.peek();
    this.url.value = URL.createObjectURL(await response.blob());
    if (before !== '') URL.revokeObjectURL(before);
  }
}

interface PosterProps {
  model: SessionModel;
  session: string;
  picture: Picture;
  nowMs: ReadonlySignal<number>;
}

/** Shows the block as it was a few seconds ago at most, where the page's own picture does not. */
export function Poster({ model, session, picture, nowMs }: PosterProps) {
  const source = useMemo(() => new PosterSource(session), [session]);
  // Null: the poster is all that the page shows of the block. Undefined: no poster.
  const place = useComputed(() =>
    picture.problem ? null : picture.posterPlace(nowMs.value),
  ).value;
  useSignalEffect(() => {
    const at = picture.problem ? null : picture.posterPlace(nowMs.value);
    if (at !== undefined) source.renew(model.state, WIDTHS[at ? 'until' : 'alone'], nowMs.value);
  });
  const { value: url } = source.url;
  const { left = 0, top = 0, width = 0 } = place ?? {};
  return (
    <img
      class={place ? 'poster placed' : 'poster'}
      alt={t('The block, drawn by the server')}
      hidden={place === undefined}
      src={url === '' ? undefined : url}
      style={place ? { left: `${left}px`, top: `${top}px`, width: `${width}px` } : undefined}
    />
  );
}
